// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What a bundle says of itself: measured rows, warnings that travel with it, and the uses it is fit for.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "model/report.hpp"

namespace heartgen {

/// `note`: good to know, such as where the fibres come from. `warning`: check this before you rely on it. `doubt`: the
/// model may be wrong as a whole; it exists because its user accepted that.
enum class WarningLevel : std::uint8_t { note, warning, doubt };

constexpr std::array<std::string_view, 3> warning_level_names = {"note", "warning", "doubt"};

struct Warning {
  std::string code;  ///< stable, for programs: "landmarks.volume", "image.synthetic"
  WarningLevel level = WarningLevel::note;
  std::string text;  ///< one or two sentences
  friend bool operator==(const Warning&, const Warning&) = default;
};

enum class Fitness : std::uint8_t { fit, fit_with_warnings, unfit };

constexpr std::array<std::string_view, 3> fitness_names = {"fit", "fit with warnings", "unfit"};

/// Whether the model serves one kind of simulation.
struct UseVerdict {
  std::string use;  ///< "eikonal", "monodomain", "mechanics", "ecg", "blood_flow", "finite_volumes"
  Fitness fitness = Fitness::fit;
  bool is_asked = false;             ///< the recipe asks for this use: unfit then fails the certificate
  std::vector<std::string> reasons;  ///< one sentence for each row or warning that speaks against it
  std::string remedy;                ///< the setting that mends it; empty where it is fit
  friend bool operator==(const UseVerdict&, const UseVerdict&) = default;
};

struct Certificate {
  Report rows;
  std::vector<Warning> warnings;
  std::vector<UseVerdict> uses;
};

/// Failed: a row fails, a use that is asked for is unfit, or the model is doubtful. Warned: anything else that a reader
/// must know. Told: nothing was judged.
inline Verdict verdict_of(const Certificate& certificate) {
  const auto has_level = [&](WarningLevel level) {
    return std::any_of(certificate.warnings.begin(), certificate.warnings.end(),
                       [&](const Warning& warning) { return warning.level == level; });
  };
  const bool is_unfit = std::any_of(certificate.uses.begin(), certificate.uses.end(), [](const UseVerdict& use) {
    return use.is_asked && use.fitness == Fitness::unfit;
  });
  if (!all_passed(certificate.rows) || is_unfit || has_level(WarningLevel::doubt)) return Verdict::failed;
  if (count_of(certificate.rows, Verdict::warned) > 0 || has_level(WarningLevel::warning)) return Verdict::warned;
  return count_of(certificate.rows, Verdict::passed) > 0 ? Verdict::passed : Verdict::told;
}

}  // namespace heartgen
