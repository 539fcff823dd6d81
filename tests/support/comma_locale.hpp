// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A scope in which numbers are written as in German, whatever locales the machine has.
#pragma once
#include <clocale>
#include <locale>
#include <string>

namespace heartgen::testing {

class CommaLocale {
 public:
  CommaLocale() : c_locale_(std::setlocale(LC_ALL, nullptr)), locale_(std::locale()) {
    std::locale::global(std::locale(std::locale::classic(), new Comma));
    std::setlocale(LC_ALL, "de_DE.UTF-8");  // where it is installed
  }
  ~CommaLocale() {
    std::locale::global(locale_);
    std::setlocale(LC_ALL, c_locale_.c_str());
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

 private:
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  std::string c_locale_;
  std::locale locale_;
};

}  // namespace heartgen::testing
