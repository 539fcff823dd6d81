// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What a stage returns: its value and what it has to say.
#pragma once
#include <tuple>
#include <vector>

#include "model/archive.hpp"
#include "model/certificate.hpp"
#include "model/part_clock.hpp"

namespace heartgen::pipeline {

using Notes = std::vector<Warning>;

template <class T>
struct Noted {
  T value{};
  Notes notes{};                  ///< what a reader of the model must know of it
  std::vector<PartTime> parts{};  ///< seconds of its parts, for the log
};

template <class T>
auto members(Noted<T>& n) {
  return std::tie(n.value, n.notes);
}

}  // namespace heartgen::pipeline

template <class T>
constexpr std::size_t heartgen::members_left_out<heartgen::pipeline::Noted<T>> = 1;  // times, for logs only
