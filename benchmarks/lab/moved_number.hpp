// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Numbers about patients under observation: which are read, and one of them moved. One object of these at a time, made
/// before the threads that read; numbers are what they are again when it goes.
#pragma once
#include <vector>

#include "model/number.hpp"

namespace heartgen::lab {

/// Notes the numbers that are read while it lives.
class NumbersRead {
 public:
  NumbersRead();
  ~NumbersRead();
  NumbersRead(const NumbersRead&) = delete;
  NumbersRead& operator=(const NumbersRead&) = delete;
  /// So far, in the order of patient_numbers().
  std::vector<const Number*> so_far() const;
};

/// Gives one number another value while it lives.
class NumberMoved {
 public:
  NumberMoved(const Number& number, double value);
  ~NumberMoved();
  NumberMoved(const NumberMoved&) = delete;
  NumberMoved& operator=(const NumberMoved&) = delete;
};

}  // namespace heartgen::lab
