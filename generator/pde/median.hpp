// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The exact median of a distributed image under a mask (thesis 6.1), without moving the values: two histograms of 16
/// bits each over the ordered bit patterns, of which the ranks add up what they need. Threads, ranks and order do not
/// matter.
///
/// The median is the lower one: the element (n - 1) / 2 of the sorted values, as std::nth_element gives it. -0 counts
/// as +0. Throws UserError, on every rank, for NaN and infinity under a label that is asked for.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

/// Median of the values where `mask` equals `label`; nothing where there is none. @collective
std::optional<float> median(const parallel::Slab<float>& values, const parallel::Slab<std::uint8_t>& mask,
                            std::uint8_t label, const parallel::Comm& comm);

/// The medians of several labels in one go. @collective
std::vector<std::optional<float>> medians(const parallel::Slab<float>& values, const parallel::Slab<std::uint8_t>& mask,
                                          std::span<const std::uint8_t> labels, const parallel::Comm& comm);

}  // namespace heartgen::pde
