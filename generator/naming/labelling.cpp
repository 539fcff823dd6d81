// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/labelling.hpp"

#include <algorithm>
#include <cmath>

#include "model/contract.hpp"
#include "model/mathematics.hpp"

namespace heartgen::naming {
namespace {

constexpr double voxel_ml = spacing_mm * spacing_mm * spacing_mm / 1000;
constexpr double face_cm2 = spacing_mm * spacing_mm / 100;

double square(double x) { return x * x; }
double half_square(double deviation, double sigma) { return 0.5 * square(deviation / sigma); }
std::size_t at(Name name) { return static_cast<std::size_t>(name); }

template <class Visit>
void for_each_name(Visit&& visit) {
  for (int n = 1; n < name_count; ++n) visit(static_cast<Name>(n));
}

/// What cm2 of open contact between two names cost; 0 where they open into each other.
std::array<std::array<double, name_count>, name_count> touch_table() {
  std::array<std::array<double, name_count>, name_count> table{};
  for (std::size_t a = 1; a < name_count; ++a)
    for (std::size_t b = 1; b < name_count; ++b) table[a][b] = a == b ? 0 : others_per_cm2;
  for (const auto& [a, b] : strangers) table[at(a)][at(b)] = table[at(b)][at(a)] = strangers_per_cm2;
  for (const auto& [a, b, none] : openings) table[at(a)][at(b)] = table[at(b)][at(a)] = 0;
  return table;
}

/// Solves a symmetric positive definite system of three equations.
Vec3 solved(const Mat3& m, const Vec3& b) {
  const Vec3 x = cross(m[1], m[2]), y = cross(m[2], m[0]), z = cross(m[0], m[1]);
  return (b.x * x + b.y * y + b.z * z) / dot(m[0], x);
}

struct Centers {
  int count = 0;
  std::array<Vec3, name_count> found, usual;
};

/// Half the squared deviations over sigma after the best shift (free), turn and scale, these at their own cost: the
/// turn and the scale are small, so that all three follow from linear equations.
double misplacement(Centers c) {
  Vec3 mean_found, mean_usual;
  for (int n = 0; n < c.count; ++n) {
    mean_found += c.found[static_cast<std::size_t>(n)] / c.count;
    mean_usual += c.usual[static_cast<std::size_t>(n)] / c.count;
  }
  const double turn_weight = square(place_sigma_mm / turn_sigma_rad), size_weight = square(place_sigma_mm / size_sigma);
  Mat3 turning{{Vec3{turn_weight, 0, 0}, Vec3{0, turn_weight, 0}, Vec3{0, 0, turn_weight}}};
  Vec3 torque;
  double rest = 0, spread = 0, stretch = 0;
  for (int n = 0; n < c.count; ++n) {
    const Vec3 m = c.usual[static_cast<std::size_t>(n)] - mean_usual;
    const Vec3 r = c.found[static_cast<std::size_t>(n)] - mean_found - m;
    rest += dot(r, r);
    spread += dot(m, m);
    stretch += dot(m, r);
    torque += cross(m, r);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) turning[a][b] += (a == b ? dot(m, m) : 0) - m[a] * m[b];
  }
  return (rest - dot(torque, solved(turning, torque)) - square(stretch) / (spread + size_weight)) /
         (2 * square(place_sigma_mm));
}

}  // namespace

Labelling::Labelling(const Problem& problem)
    : problem_(&problem), names_(problem.pieces.size(), Name::other), same_faces_(problem.pieces.size(), 0) {
  for (std::size_t n = 0; n < names_.size(); ++n) {
    add(problem.pieces[n], Name::other, 1);
    for (const auto& neighbour : problem.pieces[n].neighbours) same_faces_[n] += neighbour.faces;
  }
}

Labelling::Labelling(const Problem& problem, const std::vector<Name>& names) : Labelling(problem) {
  HEARTGEN_EXPECTS(names.size() == problem.pieces.size());
  for (std::size_t n = 0; n < names.size(); ++n) set(static_cast<int>(n), names[n]);
}

void Labelling::add(const Piece& piece, Name name, Whole sign) {
  own_terms_known_[at(name)] = false;
  Sums& s = sums_[at(name)];
  s.voxels += sign * piece.voxels;
  for (std::size_t a = 0; a < 3; ++a) {
    s.index[a] += sign * piece.index_sum[a];
    s.square[a] += sign * piece.square_sum[a];
  }
  s.hu += sign * piece.hu * piece.voxels;
  s.hu_square += sign * piece.hu * piece.hu * piece.voxels;
  s.shell += sign * piece.shell;
  s.muscle += sign * piece.muscle;
  for (std::size_t side = 0; side < 6; ++side) s.border[side] += sign * piece.border[side];
  own_ += sign * piece.own_cost[at(name)];
}

void Labelling::set(int number, Name name) {
  const auto n = static_cast<std::size_t>(number);
  const Name before = names_[n];
  if (before == name) return;
  const Piece& piece = problem_->pieces[n];
  add(piece, before, -1);
  add(piece, name, 1);
  names_[n] = name;
  for (const auto& neighbour : piece.neighbours) {
    const auto m = static_cast<std::size_t>(neighbour.piece);
    const Name beside = names_[m];
    const Whole joins = (beside == name) - (beside == before);
    same_faces_[n] += joins * neighbour.faces;
    same_faces_[m] += joins * neighbour.faces;
    cut_ -= joins * neighbour.cut;
    if (beside != before) {
      faces_[at(before)][at(beside)] -= neighbour.faces;
      faces_[at(beside)][at(before)] -= neighbour.faces;
    }
    if (beside != name) {
      faces_[at(name)][at(beside)] += neighbour.faces;
      faces_[at(beside)][at(name)] += neighbour.faces;
    }
  }
}

double Labelling::ml(Name name) const { return voxel_ml * static_cast<double>(sums(name).voxels); }

bool Labelling::holds(Name name) const { return name != Name::other && ml(name) > smallest_ml; }

double Labelling::hu(Name name) const {
  return static_cast<double>(sums(name).hu) / static_cast<double>(std::max<Whole>(sums(name).voxels, 1));
}

Vec3 Labelling::center_mm(Name name) const {
  const Sums& s = sums(name);
  const double factor = spacing_mm / static_cast<double>(std::max<Whole>(s.voxels, 1));
  return {factor * static_cast<double>(s.index[0]), factor * static_cast<double>(s.index[1]),
          factor * static_cast<double>(s.index[2])};
}

Vec3 Labelling::deviation_mm(Name name) const {
  const Sums& s = sums(name);
  const auto voxels = static_cast<double>(std::max<Whole>(s.voxels, 1));
  Vec3 result;
  for (int a = 0; a < 3; ++a) {
    const auto n = static_cast<std::size_t>(a);
    const double variance =
        static_cast<double>(s.square[n]) / voxels - square(static_cast<double>(s.index[n]) / voxels);
    result[a] = std::sqrt(std::max(variance * spacing_mm * spacing_mm, 1.0));
  }
  return result;
}

double Labelling::contact_cm2(Name a, Name b) const { return face_cm2 * static_cast<double>(faces_[at(a)][at(b)]); }

double Labelling::border_cm2(Name name, int side) const {
  return face_cm2 * static_cast<double>(sums(name).border[static_cast<std::size_t>(side)]);
}

Vec3 Labelling::mean_shift(Name without) const {
  Vec3 sum;
  int count = 0;
  for_each_name([&](Name name) {
    if (name == without || !holds(name)) return;
    sum += center_mm(name) - usual_of(name).offset_mm;
    ++count;
  });
  return count > 0 ? sum / count : 0.5 * (problem_->view_from_mm + problem_->view_to_mm);
}

Vec3 Labelling::expected_mm(Name name) const { return mean_shift(name) + usual_of(name).offset_mm; }

/// The share of a name's usual extent about its expected centre that the image shows, along the axis with the least.
double Labelling::visible_share(Name name, const Vec3& shift) const {
  double share = 1;
  for (int a = 0; a < 3; ++a) {
    const double expected = shift[a] + usual_of(name).offset_mm[a], reach = usual_of(name).deviation_mm[a];
    share = std::min({share, (expected + reach - problem_->view_from_mm[a]) / (2 * reach),
                      (problem_->view_to_mm[a] - expected + reach) / (2 * reach)});
  }
  return std::max(share, 0.0);
}

bool Labelling::holds_right_heart() const {
  return std::any_of(right_heart.begin(), right_heart.end(), [&](Name name) { return holds(name); });
}

double Labelling::missing_cost() const {
  const Vec3 shift = mean_shift(Name::other);
  double left = 0, right = 0;
  for_each_name([&](Name name) {
    if (holds(name)) return;
    const bool is_right = std::find(right_heart.begin(), right_heart.end(), name) != right_heart.end();
    (is_right ? right : left) +=
        usual_of(name).missing * (missing_outside + (1 - missing_outside) * visible_share(name, shift));
  });
  return left + (holds_right_heart() ? right : std::min(right, no_right_contrast));
}

double Labelling::place_cost() const {
  Centers centers;
  for_each_name([&](Name name) {
    if (!holds(name)) return;
    const auto n = static_cast<std::size_t>(centers.count++);
    centers.found[n] = center_mm(name);
    centers.usual[n] = usual_of(name).offset_mm;
  });
  return centers.count > 1 ? misplacement(centers) : 0;
}

double Labelling::lone_costs() const {
  std::array<Whole, name_count> largest{};
  for (std::size_t n = 0; n < names_.size(); ++n)
    largest[at(names_[n])] = std::max(largest[at(names_[n])], problem_->pieces[n].voxels);
  double cost = 0;
  for (std::size_t n = 0; n < names_.size(); ++n) {
    const Piece& piece = problem_->pieces[n];
    if (names_[n] == Name::other || piece.voxels >= largest[at(names_[n])]) continue;
    if (face_cm2 * static_cast<double>(same_faces_[n]) < lone_cm2)
      cost += lone_cost * std::min(piece.ml() / lone_ml, 1.0);
  }
  return cost;
}

/// What the image's border cuts may be smaller than usual.
Labelling::OwnTerms Labelling::own_terms(Name name) const {
  const Usual& u = usual_of(name);
  double border = 0;
  for (int side = 0; side < 6; ++side) border += border_cm2(name, side);
  const bool is_cut = border > cut_from_cm2;
  const auto unlike = [&](double value, double usual_value, double sigma) {
    const double ln = math::log(value / usual_value);
    return is_cut && ln < 0 ? 0.0 : half_square(ln, sigma);
  };
  OwnTerms own;
  own.volume = std::min(unlike(ml(name), u.ml, u.ln_sigma), max_volume_cost);
  const Vec3 deviation = deviation_mm(name);
  for (int a = 0; a < 3; ++a)
    own.shape += std::min(unlike(deviation[a], u.deviation_mm[a], ln_deviation_sigma), max_shape_cost);
  const double variance =
      static_cast<double>(sums(name).hu_square) / static_cast<double>(sums(name).voxels) - square(hu(name));
  own.grey = std::min(0.5 * std::max(variance, 0.0) / square(u.grey_spread * problem_->contrast_hu), max_grey_cost);
  return own;
}

Terms Labelling::terms() const {
  static const auto touch = touch_table();
  Terms t;
  t.piece = cost_unit * static_cast<double>(own_);
  t.cut = cost_unit * static_cast<double>(cut_);
  t.missing = missing_cost();
  t.place = place_cost();
  t.lone = lone_costs();
  const double contrast = problem_->contrast_hu;
  for_each_name([&](Name name) {
    for (int b = static_cast<int>(name) + 1; b < name_count; ++b)
      t.touch += touch[at(name)][static_cast<std::size_t>(b)] * contact_cm2(name, static_cast<Name>(b));
    if (!holds(name)) return;
    if (!own_terms_known_[at(name)]) own_terms_[at(name)] = own_terms(name);
    own_terms_known_[at(name)] = true;
    t.volume += own_terms_[at(name)].volume;
    t.shape += own_terms_[at(name)].shape;
    t.grey += own_terms_[at(name)].grey;
  });
  if (holds(Name::lv)) {
    const Sums& s = sums(Name::lv);
    const double muscle = s.shell > 0 ? static_cast<double>(s.muscle) / static_cast<double>(s.shell) : 0;
    t.shell = half_square(std::max(usual_muscle_share - muscle, 0.0), muscle_share_sigma);
  }
  for (const auto& [from, to, none] : openings) {
    const double cm2 = contact_cm2(from, to);
    t.touch += too_wide_per_cm2 * std::max(cm2 - widest_opening_cm2, 0.0);
    if (holds(from) && holds(to)) t.opening += none * math::exp(-cm2 / opening_cm2);
  }
  for (const auto& [from, to, sigma, at_most] : streams)
    if (holds(from) && holds(to)) t.stream += std::min(half_square(hu(from) - hu(to), sigma * contrast), at_most);
  return t;
}

}  // namespace heartgen::naming
