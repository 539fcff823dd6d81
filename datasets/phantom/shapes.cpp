// SPDX-License-Identifier: GPL-3.0-or-later
#include "datasets/phantom/shapes.hpp"

namespace heartgen::phantom {

double round_cone(const Vec3& p, const Vec3& a, const Vec3& b, double ra, double rb) {
  const Vec3 ab = b - a, ap = p - a;
  const double length2 = dot(ab, ab);
  const double t = length2 > 0 ? std::clamp(dot(ap, ab) / length2, 0.0, 1.0) : 0.0;
  return norm(ap - t * ab) - (ra + t * (rb - ra));
}

double thick_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, double half_thickness) {
  const Vec3 corners[3] = {a, b, c};
  const Vec3 normal = normalized(cross(b - a, c - a));
  bool over = true;
  double edge = 1e30;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &from = corners[i], &to = corners[(i + 1) % 3];
    over = over && dot(cross(normal, to - from), p - from) >= 0;
    edge = std::min(edge, round_cone(p, from, to, 0, 0));
  }
  return (over ? std::abs(dot(p - a, normal)) : edge) - half_thickness;
}

std::vector<CurvePoint> smooth_curve(const std::vector<CurvePoint>& control, int pieces) {
  std::vector<CurvePoint> curve;
  const int n = static_cast<int>(control.size());
  const auto at = [&](int i) { return control[static_cast<std::size_t>(std::clamp(i, 0, n - 1))]; };
  for (int i = 0; i + 1 < n; ++i)
    for (int piece = 0; piece < pieces; ++piece) {
      const double t = static_cast<double>(piece) / pieces, t2 = t * t, t3 = t2 * t;
      const double w[4] = {(-t3 + 2 * t2 - t) / 2, (3 * t3 - 5 * t2 + 2) / 2, (-3 * t3 + 4 * t2 + t) / 2,
                           (t3 - t2) / 2};
      CurvePoint point;
      for (int k = 0; k < 4; ++k) point.at += w[k] * at(i + k - 1).at;
      point.radius = at(i).radius + t * (at(i + 1).radius - at(i).radius);
      curve.push_back(point);
    }
  curve.push_back(control.back());
  return curve;
}

Tube::Tube(std::vector<CurvePoint> curve, double reach_mm) {
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) add(curve[i], curve[i + 1]);
  curve_ = std::move(curve);
  finish(reach_mm);
}

void Tube::add(const CurvePoint& from, const CurvePoint& to) {
  const Vec3 along = to.at - from.at;
  const double length2 = dot(along, along);
  pieces_.push_back({from.at, along, length2 > 0 ? 1 / length2 : 0, from.radius, to.radius - from.radius});
}

Tube::CellRange Tube::cells_near(const Piece& piece) const {
  CellRange range;
  const double margin = std::max(piece.ra, piece.ra + piece.taper) + reach_mm_;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = piece.a[axis], b = a + piece.ab[axis];
    range.from[axis] = std::max(static_cast<int>((std::min(a, b) - margin - low_[axis]) / cube_mm_), 0);
    range.to[axis] = std::min(static_cast<int>((std::max(a, b) + margin - low_[axis]) / cube_mm_), count_[axis] - 1);
  }
  return range;
}

void Tube::finish(double reach_mm) {
  reach_mm_ = reach_mm;
  Vec3 low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
  for (const auto& piece : pieces_)
    for (int axis = 0; axis < 3; ++axis) {
      const double margin = std::max(piece.ra, piece.ra + piece.taper) + reach_mm;
      low[axis] = std::min({low[axis], piece.a[axis] - margin, piece.a[axis] + piece.ab[axis] - margin});
      high[axis] = std::max({high[axis], piece.a[axis] + margin, piece.a[axis] + piece.ab[axis] + margin});
    }
  low_ = low;
  for (int axis = 0; axis < 3; ++axis)
    count_[axis] = pieces_.empty() ? 0 : static_cast<int>((high[axis] - low[axis]) / cube_mm_) + 1;
  std::vector<std::vector<std::int32_t>> cells(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]));
  for (std::size_t id = 0; id < pieces_.size(); ++id) enter(id, cells);
  start_.assign(1, 0);
  for (const auto& cell : cells) {
    list_.insert(list_.end(), cell.begin(), cell.end());
    start_.push_back(static_cast<std::int32_t>(list_.size()));
  }
}

void Tube::enter(std::size_t id, std::vector<std::vector<std::int32_t>>& cells) const {
  const auto& piece = pieces_[id];
  const auto range = cells_near(piece);
  // Half a cube's diagonal, and twice the taper: how much faster than 1 mm/mm a cone's value may change.
  const double slack = reach_mm_ + cube_mm_ * 0.8661 + 2 * std::abs(piece.taper);
  for (int k = range.from[2]; k <= range.to[2]; ++k)
    for (int j = range.from[1]; j <= range.to[1]; ++j)
      for (int i = range.from[0]; i <= range.to[0]; ++i)
        if (piece.distance(low_ + cube_mm_ * Vec3{i + 0.5, j + 0.5, k + 0.5}) < slack)
          cells[cell_index(i, j, k)].push_back(static_cast<std::int32_t>(id));
}

double Tube::operator()(const Vec3& p) const {
  const Vec3 cell = (p - low_) * (1 / cube_mm_);
  if (!(cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < count_[0] && cell.y < count_[1] && cell.z < count_[2]))
    return reach_mm_;
  const auto index = cell_index(static_cast<int>(cell.x), static_cast<int>(cell.y), static_cast<int>(cell.z));
  double distance = reach_mm_;
  const auto* end = list_.data() + start_[index + 1];
  for (const auto* id = list_.data() + start_[index]; id != end; ++id)
    distance = std::min(distance, pieces_[static_cast<std::size_t>(*id)].distance(p));
  return distance;
}

Vec3 Tube::nearest_direction(const Vec3& p) const {
  const auto nearer = [&](const Piece& a, const Piece& b) { return a.distance(p) < b.distance(p); };
  const auto nearest = std::min_element(pieces_.begin(), pieces_.end(), nearer);
  return nearest == pieces_.end() ? Vec3{} : normalized(nearest->ab);
}

HeightTable::HeightTable(const std::vector<double>& z, const std::vector<double>& value) : low_(z.front()), samples_() {
  const auto secant = [&](std::size_t k) { return (value[k + 1] - value[k]) / (z[k + 1] - z[k]); };
  const auto slope = [&](std::size_t k) {  // harmonic mean of the neighbouring secants: no overshoot
    if (k == 0 || k + 1 == z.size()) return 0.0;
    const double a = secant(k - 1), b = secant(k);
    return a * b > 0 ? 2 * a * b / (a + b) : 0.0;
  };
  std::size_t i = 0;
  for (int step = 0; low_ + step <= z.back(); ++step) {
    const double height = low_ + step;
    while (i + 2 < z.size() && height > z[i + 1]) ++i;
    const double span = z[i + 1] - z[i], t = (height - z[i]) / span, t2 = t * t, t3 = t2 * t;
    samples_.push_back((2 * t3 - 3 * t2 + 1) * value[i] + (t3 - 2 * t2 + t) * span * slope(i) +
                       (-2 * t3 + 3 * t2) * value[i + 1] + (t3 - t2) * span * slope(i + 1));
  }
}

std::uint64_t random_bits(std::uint64_t key, std::uint64_t counter) {
  std::uint64_t x = key * 0x9E3779B97F4A7C15ull + counter;
  for (int round = 0; round < 2; ++round) {
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    x = (x ^ (x >> 31)) + 0x9E3779B97F4A7C15ull;
  }
  return x ^ (x >> 32);
}

double random_symmetric(std::uint64_t key, std::uint64_t counter) {
  return static_cast<double>(random_bits(key, counter) >> 11) * 0x1.0p-52 - 1;
}

float random_normal(std::uint64_t key, std::uint64_t counter) {
  std::int64_t sum = 0;
  for (std::uint64_t half = 0; half < 2; ++half) {
    const std::uint64_t bits = random_bits(key, 2 * counter + half);
    for (int lane = 0; lane < 4; ++lane) sum += static_cast<std::int64_t>((bits >> (16 * lane)) & 0xFFFF);
  }
  // Eight uniforms on 0..65535 have mean 8 * 32767.5 and variance 8 * 65536^2 / 12.
  constexpr float scale = 1.2247449f / 65536.0f;
  return static_cast<float>(sum - 262140) * scale;
}

}  // namespace heartgen::phantom
