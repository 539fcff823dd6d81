// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/solve.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "generator/parallel/tasks.hpp"
#include "model/mathematics.hpp"

namespace heartgen::naming {
namespace {

constexpr double least_gain = 1e-9;

bool is_fixed(const Fixed& fixed, int piece) { return !fixed.empty() && fixed[static_cast<std::size_t>(piece)]; }

const Piece& piece_of(const Labelling& labelling, int n) {
  return labelling.problem().pieces[static_cast<std::size_t>(n)];
}

/// 64 well-mixed bits of a key and a counter (Steele, Lea and Flood 2014).
struct Random {
  std::uint64_t state;
  std::uint64_t bits() {
    state += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(bits() % count); }
  double share() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
};

/// A small set of names, in the order of the names.
class Choice {
 public:
  void add(Name name) { bits_ |= 1U << static_cast<unsigned>(name); }
  void remove(Name name) { bits_ &= ~(1U << static_cast<unsigned>(name)); }
  bool holds(Name name) const { return (bits_ >> static_cast<unsigned>(name)) & 1U; }
  std::vector<Name> names() const {
    std::vector<Name> result;
    for (int n = 0; n < name_count; ++n)
      if (holds(static_cast<Name>(n))) result.push_back(static_cast<Name>(n));
    return result;
  }

 private:
  unsigned bits_ = 0;
};

void add_neighbours(const Labelling& labelling, int piece, Choice& choice) {
  for (const auto& neighbour : piece_of(labelling, piece).neighbours) choice.add(labelling[neighbour.piece]);
}

/// The three names whose usual place is nearest to the piece, as seen from the left ventricle.
void add_nearest(const Labelling& labelling, int piece, double within_mm, Choice& choice) {
  const Vec3 shift = labelling.center_mm(Name::lv), center = piece_of(labelling, piece).center_mm();
  std::array<std::pair<double, int>, name_count - 1> far;
  for (int n = 1; n < name_count; ++n)
    far[static_cast<std::size_t>(n - 1)] = {norm(center - shift - usual[static_cast<std::size_t>(n)].offset_mm), n};
  std::partial_sort(far.begin(), far.begin() + 3, far.end());
  for (std::size_t n = 0; n < 3; ++n)
    if (far[n].first < within_mm) choice.add(static_cast<Name>(far[n].second));
}

/// Tries names for a piece and keeps the best; returns whether that is another one.
bool improve_piece(Labelling& labelling, int piece, const Choice& choice, double& energy) {
  const Name before = labelling[piece];
  Name best = before;
  for (const Name name : choice.names()) {
    if (name == before) continue;
    labelling.set(piece, name);
    if (const double e = labelling.energy(); e < energy - least_gain) {
      energy = e;
      best = name;
    }
  }
  labelling.set(piece, best);
  return best != before;
}

std::vector<int> largest_first(const Problem& problem) {
  std::vector<int> order(problem.pieces.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return problem.pieces[static_cast<std::size_t>(a)].voxels > problem.pieces[static_cast<std::size_t>(b)].voxels;
  });
  return order;
}

void rename(Labelling& labelling, const std::vector<Name>& names) {
  for (int n = 0; n < labelling.size(); ++n) labelling.set(n, names[static_cast<std::size_t>(n)]);
}

/// Two names exchanged, or the blood of one given to the other.
bool improve_pair(Labelling& labelling, Name a, Name b, const Fixed& fixed, double& energy) {
  const std::vector<Name> before = labelling.names();
  for (const auto& [of_a, of_b] : {std::pair{b, a}, {b, b}, {a, a}}) {
    std::vector<Name> names = before;
    for (std::size_t n = 0; n < names.size(); ++n)
      if (fixed.empty() || !fixed[n]) names[n] = names[n] == a ? of_a : names[n] == b ? of_b : names[n];
    if (names == before) continue;
    rename(labelling, names);
    if (const double e = labelling.energy(); e < energy - least_gain) {
      energy = e;
      return true;
    }
  }
  rename(labelling, before);
  return false;
}

/// The pieces around one lately renamed settle.
void settle(Labelling& labelling, const std::vector<int>& pieces, int kept, const Fixed& fixed, double& energy) {
  constexpr int sweeps = 2;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    bool moved = false;
    for (const int piece : pieces) {
      if (piece == kept || is_fixed(fixed, piece)) continue;
      Choice choice;
      choice.add(Name::other);
      add_neighbours(labelling, piece, choice);
      moved |= improve_piece(labelling, piece, choice, energy);
    }
    if (!moved) return;
  }
}

/// Neighbours and their neighbours that matter, the largest first, at most fourteen.
std::vector<int> surroundings(const Labelling& labelling, int piece) {
  constexpr std::size_t at_most = 14;
  constexpr double matters = 0.1;
  std::vector<int> around{piece};
  for (const auto& near : piece_of(labelling, piece).neighbours) {
    around.push_back(near.piece);
    for (const auto& far : piece_of(labelling, near.piece).neighbours) around.push_back(far.piece);
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  std::erase_if(around, [&](int n) {
    return labelling[n] == Name::other &&
           cost_unit * static_cast<double>(piece_of(labelling, n).own_cost[0]) <= matters;
  });
  std::stable_sort(around.begin(), around.end(),
                   [&](int a, int b) { return piece_of(labelling, a).voxels > piece_of(labelling, b).voxels; });
  if (around.size() > at_most) around.resize(at_most);
  return around;
}

/// Running sums of how often each piece is chosen: large, deep pieces that have or want a name.
std::vector<double> running_weights(const Labelling& labelling) {
  constexpr double deep_enough_mm = 12, wanted = 0.2;
  std::vector<double> sums;
  double sum = 0;
  for (int n = 0; n < labelling.size(); ++n) {
    const Piece& piece = piece_of(labelling, n);
    const bool matters = labelling[n] != Name::other || cost_unit * static_cast<double>(piece.own_cost[0]) > wanted;
    if (piece.room_depth_mm > deep_enough_mm && matters) sum += std::sqrt(piece.ml());
    sums.push_back(sum);
  }
  return sums;
}

bool is_right(Name name) { return std::find(right_heart.begin(), right_heart.end(), name) != right_heart.end(); }

/// One start: a left ventricle, and every other piece named after the usual place it is nearest to; of the left heart
/// alone, where contrast has not reached the right one.
std::vector<Name> start_from(const Problem& problem, int ventricle, double size, double turn_rad, bool left_alone) {
  constexpr double farthest = 1.3;  // of a name's usual extent
  const double c = math::cos(turn_rad), s = math::sin(turn_rad);
  const Vec3 origin = problem.pieces[static_cast<std::size_t>(ventricle)].center_mm();
  std::vector<Name> names;
  for (const auto& piece : problem.pieces) {
    double nearest = farthest;
    Name best = Name::other;
    for (int n = 1; n < name_count; ++n) {
      if (left_alone && is_right(static_cast<Name>(n))) continue;
      const Usual& u = usual[static_cast<std::size_t>(n)];
      const Vec3 turned{c * u.offset_mm.x - s * u.offset_mm.y, s * u.offset_mm.x + c * u.offset_mm.y, u.offset_mm.z};
      const double distance = norm(piece.center_mm() - origin - size * turned) / norm(u.deviation_mm);
      if (distance >= nearest) continue;
      nearest = distance;
      best = static_cast<Name>(n);
    }
    names.push_back(best);
  }
  names[static_cast<std::size_t>(ventricle)] = Name::lv;
  return names;
}

/// Large pieces of deep blood with muscle around them, the likeliest first.
std::vector<int> possible_ventricles(const Problem& problem) {
  constexpr double softness = 0.15, deep_enough_mm = 12, before_spine_mm = 30, least_ml = 6;
  constexpr std::size_t at_most = 8;
  std::vector<std::pair<double, int>> found;
  for (int n = 0; n < static_cast<int>(problem.pieces.size()); ++n) {
    const Piece& piece = problem.pieces[static_cast<std::size_t>(n)];
    if (piece.room_depth_mm <= deep_enough_mm || piece.from_spine_mm.y > -before_spine_mm || piece.shell == 0) continue;
    const double muscle = static_cast<double>(piece.muscle) / static_cast<double>(piece.shell);
    const double lack = std::max(usual_muscle_share - muscle, 0.0) / softness;
    const double score = piece.ml() * math::exp(-0.5 * lack * lack);
    if (score > least_ml) found.emplace_back(-score, n);
  }
  std::sort(found.begin(), found.end());
  if (found.size() > at_most) found.resize(at_most);
  std::vector<int> pieces;
  for (const auto& [score, n] : found) pieces.push_back(n);
  return pieces;
}

void sort_by_energy(std::vector<Solution>& solutions) {
  std::stable_sort(solutions.begin(), solutions.end(),
                   [](const Solution& a, const Solution& b) { return a.energy < b.energy; });
}

std::vector<Solution> starts(const Problem& problem, bool left_alone) {
  std::vector<Solution> result;
  for (const int ventricle : possible_ventricles(problem))
    for (const double size : {.8, 1., 1.2})
      for (const double turn : {-.4, 0., .4}) {
        auto names = start_from(problem, ventricle, size, turn, left_alone);
        const double energy = Labelling(problem, names).energy();
        result.push_back({std::move(names), energy});
      }
  sort_by_energy(result);
  return result;
}

void keep_first(std::vector<Solution>& solutions, int count) {
  if (std::ssize(solutions) > count) solutions.resize(static_cast<std::size_t>(count));
}

/// Each solution by itself, on all threads.
template <class Improve>
void improve_each(const Problem& problem, std::vector<Solution>& solutions, Improve&& improve) {
  std::vector<std::function<void()>> tasks;
  for (std::size_t n = 0; n < solutions.size(); ++n)
    tasks.emplace_back([&, n] {
      Labelling labelling(problem, solutions[n].names);
      const double energy = improve(labelling, n);
      solutions[n] = {labelling.names(), energy};
    });
  parallel::run_tasks(tasks);
  sort_by_energy(solutions);
  const auto same = [](const Solution& a, const Solution& b) { return a.names == b.names; };
  solutions.erase(std::unique(solutions.begin(), solutions.end(), same), solutions.end());
}

/// Whole names from other solutions, where that is better.
double take_over(Labelling& labelling, const std::vector<Solution>& others) {
  double energy = labelling.energy();
  for (const auto& other : others)
    for (int n = 1; n < name_count; ++n) {
      const auto name = static_cast<Name>(n);
      const auto before = labelling.names();
      for (int p = 0; p < labelling.size(); ++p)
        if (other.names[static_cast<std::size_t>(p)] == name)
          labelling.set(p, name);
        else if (labelling[p] == name)
          labelling.set(p, Name::other);
      const double e = descend(labelling, {}, 2);
      if (e < energy - least_gain)
        energy = e;
      else
        rename(labelling, before);
    }
  return energy;
}

/// Each name once more from where the others say that it is.
double seed_again(Labelling& labelling) {
  constexpr double reach = 1.5, large_ml = 25;
  double energy = labelling.energy();
  for (int n = 1; n < name_count; ++n)
    for (const double size : {.8, 1.4}) {
      const auto name = static_cast<Name>(n);
      const Vec3 expected = labelling.expected_mm(name), extent = usual_of(name).deviation_mm;
      const auto before = labelling.names();
      for (int p = 0; p < labelling.size(); ++p) {
        const Piece& piece = piece_of(labelling, p);
        const Vec3 off = piece.center_mm() - expected;
        const bool is_near = std::abs(off.x) < reach * size * extent.x && std::abs(off.y) < reach * size * extent.y &&
                             std::abs(off.z) < reach * size * extent.z;
        const bool is_free = labelling[p] == Name::other || labelling[p] == name || piece.ml() < large_ml;
        if (is_near && is_free)
          labelling.set(p, name);
        else if (labelling[p] == name)
          labelling.set(p, Name::other);
      }
      const double e = descend(labelling, {}, 3);
      if (e < energy - least_gain)
        energy = e;
      else
        rename(labelling, before);
    }
  return energy;
}

/// All names but those of the left ventricle and atrium anew, by the usual place that each piece is nearest to, as
/// these two see it.
std::vector<Name> around_left_heart(const Problem& problem, const std::vector<Name>& names, double size,
                                    double turn_rad) {
  constexpr double farthest = 1.3;  // of a name's usual extent
  const Labelling labelling(problem, names);
  const double c = math::cos(turn_rad), s = math::sin(turn_rad);
  const auto place = [&](Name name) {
    const Vec3 off = usual_of(name).offset_mm;
    return size * Vec3{c * off.x - s * off.y, s * off.x + c * off.y, off.z};
  };
  const Vec3 origin =
      0.5 * (labelling.center_mm(Name::lv) - place(Name::lv) + labelling.center_mm(Name::la) - place(Name::la));
  std::vector<Name> result = names;
  for (std::size_t p = 0; p < names.size(); ++p) {
    if (names[p] == Name::lv || names[p] == Name::la) continue;
    double nearest = farthest;
    result[p] = Name::other;
    for (int n = 1; n < name_count; ++n) {
      const auto name = static_cast<Name>(n);
      if (name == Name::lv || name == Name::la) continue;
      const double distance =
          norm(problem.pieces[p].center_mm() - origin - place(name)) / norm(usual_of(name).deviation_mm);
      if (distance >= nearest) continue;
      nearest = distance;
      result[p] = name;
    }
  }
  return result;
}

/// Starts from the left heart of the first solutions, which is found more surely than what lies around it.
std::vector<Solution> second_starts(const Problem& problem, const std::vector<Solution>& first, int count) {
  std::vector<Solution> result;
  for (int n = 0; n < std::min<int>(count, static_cast<int>(first.size())); ++n) {
    const auto& names = first[static_cast<std::size_t>(n)].names;
    const Labelling labelling(problem, names);
    if (!labelling.holds(Name::lv) || !labelling.holds(Name::la)) continue;
    for (const double size : {.8, .95, 1.1, 1.25})
      for (const double turn : {-.4, -.2, 0., .2, .4})
        result.push_back({around_left_heart(problem, names, size, turn), 0});
  }
  return result;
}

}  // namespace

double descend(Labelling& labelling, const Fixed& fixed, int sweeps) {
  constexpr double within_mm = 45;
  double energy = labelling.energy();
  const auto order = largest_first(labelling.problem());
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    bool moved = false;
    for (const int piece : order) {
      if (is_fixed(fixed, piece)) continue;
      Choice choice;
      choice.add(Name::other);
      add_neighbours(labelling, piece, choice);
      if (labelling.holds(Name::lv)) add_nearest(labelling, piece, within_mm, choice);
      moved |= improve_piece(labelling, piece, choice, energy);
    }
    for (int a = 1; a < name_count; ++a)
      for (int b = a + 1; b < name_count; ++b)
        moved |= improve_pair(labelling, static_cast<Name>(a), static_cast<Name>(b), fixed, energy);
    if (!moved) break;
  }
  return energy;
}

double shake(Labelling& labelling, std::uint64_t key, int times, const Fixed& fixed) {
  constexpr double joins = 0.5;
  double energy = labelling.energy();
  Random random{key};
  const auto weights = running_weights(labelling);
  if (weights.empty() || !(weights.back() > 0)) return energy;
  for (int n = 0; n < times; ++n) {
    const auto chosen = std::upper_bound(weights.begin(), weights.end(), random.share() * weights.back());
    const int piece = static_cast<int>(std::min(chosen - weights.begin(), std::ssize(weights) - 1));
    if (is_fixed(fixed, piece)) continue;
    Choice choice;
    add_neighbours(labelling, piece, choice);
    add_nearest(labelling, piece, 1e9, choice);
    choice.remove(labelling[piece]);
    const auto names = choice.names();
    const Name before = labelling[piece], name = names[random.below(names.size())];
    const auto all_before = labelling.names();
    labelling.set(piece, name);
    for (const auto& neighbour : piece_of(labelling, piece).neighbours)
      if (!is_fixed(fixed, neighbour.piece) && labelling[neighbour.piece] == before && random.share() < joins)
        labelling.set(neighbour.piece, name);
    double e = labelling.energy();
    settle(labelling, surroundings(labelling, piece), piece, fixed, e);
    if (e < energy - least_gain)
      energy = e;
    else
      rename(labelling, all_before);
  }
  return energy;
}

std::vector<Name> solve(const Problem& problem, const Effort& effort) {
  auto solutions = starts(problem, false), left = starts(problem, true);
  if (solutions.empty()) return {};
  keep_first(solutions, effort.starts);
  keep_first(left, effort.starts / 4);
  solutions.insert(solutions.end(), left.begin(), left.end());
  const auto to_minimum = [](Labelling& labelling, std::size_t) { return descend(labelling); };
  improve_each(problem, solutions, to_minimum);
  auto second = second_starts(problem, solutions, effort.restarted);
  improve_each(problem, second, to_minimum);
  solutions.insert(solutions.end(), second.begin(), second.end());
  sort_by_energy(solutions);
  keep_first(solutions, effort.shaken);
  improve_each(problem, solutions,
               [&](Labelling& labelling, std::size_t n) { return shake(labelling, n + 1, effort.shakes); });
  Labelling best(problem, solutions.front().names);
  take_over(best, {solutions.begin() + 1, solutions.end()});
  seed_again(best);
  shake(best, 0, effort.final_shakes);
  descend(best);
  return best.names();
}

}  // namespace heartgen::naming
