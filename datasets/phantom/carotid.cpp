// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "datasets/phantom/companions.hpp"
#include "datasets/phantom/image.hpp"
#include "model/mathematics.hpp"

namespace heartgen::phantom {
namespace {

/// Left carotid arteries and jugular vein in a frame of their own (mm, the bifurcation at the origin, z up).
struct Neck {
  Tube lumen, vein;
  Vec3 seed;
};

Neck make_neck(int variant) {
  const auto key = 0xCA0ull + static_cast<std::uint64_t>(variant);
  const auto draw = [&](std::uint64_t counter, double spread) {
    return variant == 0 ? 0.0 : spread * random_symmetric(key, counter);
  };
  const double k = 1 + draw(0, 0.1), turn = draw(1, 2.5);
  const Vec3 seed{-1.5, 1.5 + turn / 4, -22};
  const std::vector<CurvePoint> common = {
      {{-3, 4, -48}, 3.2 * k}, {seed, 3.2 * k}, {{0, 0, -6}, 3.4 * k}, {{0.5, 0.5, 0}, 3.6 * k}};
  // The bulb of the internal carotid, then its course up and back; the external one turns forward.
  const std::vector<CurvePoint> internal = {{{0, 0, -6}, 3.4 * k},
                                            {{1.6, 1.6, 3}, 3.7 * k},
                                            {{3.6, 3.8 + turn, 10}, 3.1 * k},
                                            {{4.8, 5.6 + turn, 22}, 2.4 * k},
                                            {{4.2, 7 + turn, 48}, 2.3 * k}};
  const std::vector<CurvePoint> external = {{{0, 0, -6}, 3.2 * k},
                                            {{-1.4, -1.8, 3}, 2.6 * k},
                                            {{-2.6, -4.6, 11}, 2.1 * k},
                                            {{-3, -6.4 - turn, 24}, 1.9 * k},
                                            {{-2, -8 - turn, 48}, 1.7 * k}};
  Neck neck;
  for (const auto& control : {common, internal, external}) {
    const auto curve = smooth_curve(control, 8);
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) neck.lumen.add(curve[i], curve[i + 1]);
  }
  neck.lumen.finish(4);
  neck.vein = Tube(smooth_curve({{{9, 5, -48}, 5}, {{10, 6, 0}, 5.2}, {{9, 12, 48}, 4.2}}, 8), 2);
  neck.seed = seed;
  return neck;
}

float grey_of(const Neck& neck, const Vec3& p) {
  if (neck.lumen(p) < 0) return 390;
  if (neck.lumen(p) < 0.9) return 70;
  if (neck.vein(p) < 0) return 150;
  const double muscle = math::hypot(p.x - 4, p.y + 20) - 9, back = math::hypot(p.x + 2, p.y - 30) - 17;
  const double airway = math::hypot(p.x + 26, p.y + 8) - 8;
  if (airway < 0) return -1000;
  if (airway < 2) return 90;
  return std::min(muscle, back) < 0 ? 60 : -85;
}

}  // namespace

void add_carotid(Phantom& phantom, int variant, double noise_hu, const Vec3& spacing_mm) {
  const Neck neck = make_neck(variant);
  const Vec3 field_mm{36, 36, 84};
  Grid grid;
  grid.spacing_mm = spacing_mm;
  for (int axis = 0; axis < 3; ++axis) {
    const auto voxels = std::max(8L, std::lround(field_mm[axis] / spacing_mm[axis]));
    grid.size[static_cast<std::size_t>(axis)] = voxels;
    grid.origin_mm[axis] = -0.5 * static_cast<double>(voxels - 1) * spacing_mm[axis];
  }
  Volume<float> image(grid);
  phantom.carotid_labels = LabelVolume(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const Vec3 center{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        const bool in_lumen = neck.lumen(lps_from_index(grid, center)) < 0;
        phantom.carotid_labels(i, j, k) = tag(in_lumen ? Region::carotid : Region::torso);
        for (int part = 0; part < 8; ++part) {
          const Vec3 shift{0.25 - 0.5 * (part & 1), 0.25 - 0.5 * ((part >> 1) & 1), 0.25 - 0.5 * (part >> 2)};
          image(i, j, k) += grey_of(neck, lps_from_index(grid, center + shift)) / 8;
        }
      }
  blur(image, 0.35);
  add_noise(image, noise_hu, 0xCA + static_cast<std::uint64_t>(variant));
  phantom.carotid = rounded(image, -1024, 3071);
  phantom.carotid_seed_mm = neck.seed;
}

}  // namespace heartgen::phantom
