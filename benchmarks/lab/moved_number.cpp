// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/moved_number.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>

#include "model/contract.hpp"
#include "model/numbers.hpp"

namespace heartgen::lab {
namespace {

constexpr std::size_t most_numbers = 512;
std::array<std::atomic<bool>, most_numbers> was_read;  // by the place in by_address()

const std::vector<const Number*>& by_address() {
  static const auto sorted = [] {
    std::vector<const Number*> numbers(patient_numbers().begin(), patient_numbers().end());
    std::sort(numbers.begin(), numbers.end(), std::less<>());
    return numbers;
  }();
  return sorted;
}

std::size_t place_of(const Number& number) {
  const auto& all = by_address();
  return static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), &number, std::less<>()) - all.begin());
}

double noted(const Number& number) {
  was_read[place_of(number)].store(true, std::memory_order_relaxed);
  return number.value;
}

const Number* moved = nullptr;
double moved_to = 0;

double moved_or_own(const Number& number) { return &number == moved ? moved_to : number.value; }

}  // namespace

NumbersRead::NumbersRead() {
  HEARTGEN_EXPECTS(read_number_instead == nullptr && by_address().size() <= most_numbers);
  for (auto& one : was_read) one.store(false, std::memory_order_relaxed);
  read_number_instead = noted;
}

NumbersRead::~NumbersRead() { read_number_instead = nullptr; }

std::vector<const Number*> NumbersRead::so_far() const {
  std::vector<const Number*> numbers;
  for (const Number* number : patient_numbers())
    if (was_read[place_of(*number)].load(std::memory_order_relaxed)) numbers.push_back(number);
  return numbers;
}

NumberMoved::NumberMoved(const Number& number, double value) {
  HEARTGEN_EXPECTS(read_number_instead == nullptr);
  moved = &number;
  moved_to = value;
  read_number_instead = moved_or_own;
}

NumberMoved::~NumberMoved() { read_number_instead = nullptr; }

}  // namespace heartgen::lab
