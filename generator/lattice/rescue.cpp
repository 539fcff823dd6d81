#include "generator/lattice/rescue.hpp"

#include <algorithm>
#include <vector>

#include "generator/lattice/place.hpp"

namespace heart::lattice {
namespace {

constexpr int rings = 3;  // of cells around a bad one
constexpr int most_tries = 12;

// Makes `best` the best of some repairs of a place.
void try_repairs(const Complex& part, const Materials& materials, const RepairSettings& settings, double enough,
                 Complex& best) {
  for (int attempt = 0; attempt < most_tries && worst_quality(best) < enough; ++attempt) {
    Complex tried = part;
    if (attempt > 0) shake_up(tried, materials, 0.04 + 0.04 * (attempt % 4), static_cast<std::uint32_t>(attempt));
    repair(tried, materials, settings);
    if (worst_quality(tried) > worst_quality(best)) best = std::move(tried);
  }
}

// Shakes of all the cells below the goal take most of the time; places that need them are few.
Complex best_repair(const Complex& part, const Materials& materials, RepairSettings settings, double enough) {
  settings.may_relabel = false;  // labels beyond the place are not seen
  RepairSettings modest = settings, thorough = settings;
  modest.least = enough;
  thorough.least = thorough.goal;
  thorough.sweeps *= 2;
  Complex best = part;
  try_repairs(part, materials, modest, enough, best);
  try_repairs(part, materials, thorough, enough, best);
  return best;
}

// The worst first.
std::vector<std::int32_t> cells_below(const Complex& c, double enough) {
  std::vector<std::int32_t> bad;
  for (std::size_t i = 0; i < c.quality.size(); ++i)
    if (static_cast<double>(c.quality[i]) < enough) bad.push_back(static_cast<std::int32_t>(i));
  std::stable_sort(bad.begin(), bad.end(), [&](auto a, auto b) { return c.quality_of(a) < c.quality_of(b); });
  return bad;
}

}  // namespace

std::int64_t rescue(Complex& complex, const Materials& materials, const RepairSettings& settings, double enough) {
  constexpr std::size_t most_cells = 30;  // more are not a few: the whole has to be made in another way
  const auto bad = cells_below(complex, enough);
  if (bad.size() > most_cells) return static_cast<std::int64_t>(bad.size());
  for (const auto id : bad) {
    if (!complex.is_alive(id) || complex.quality_of(id) >= enough) continue;
    auto place = place_around(complex, id, rings);
    const auto repaired = best_repair(place.part, materials, settings, enough);
    if (worst_quality(repaired) > worst_quality(place.part)) put_back(complex, place, repaired);
    if (worst_quality(repaired) < enough) break;  // nothing makes the whole good enough now
  }
  return static_cast<std::int64_t>(cells_below(complex, enough).size());
}

}  // namespace heart::lattice
