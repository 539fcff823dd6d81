// SPDX-License-Identifier: GPL-3.0-or-later

#include "datasets/phantom/companions.hpp"
#include "datasets/phantom/image.hpp"
#include "model/mathematics.hpp"

namespace heartgen::phantom {
namespace {

/// Grey values of a T1-like image: fat and marrow bright, flowing blood, air and compact bone dark.
std::array<float, tissue_count> mr_values() {
  std::array<float, tissue_count> value{};
  const auto set = [&](Tissue tissue, float grey) { value[static_cast<std::size_t>(tissue)] = grey; };
  set(Tissue::air, 8);
  set(Tissue::lung, 45);
  set(Tissue::fat, 820);
  set(Tissue::muscle, 300);
  set(Tissue::myocardium, 330);
  set(Tissue::liver, 400);
  set(Tissue::cortical_bone, 30);
  set(Tissue::marrow, 560);
  set(Tissue::cartilage, 260);
  set(Tissue::left_blood, 120);
  set(Tissue::right_blood, 130);
  set(Tissue::upper_vein, 130);
  set(Tissue::vessel_wall, 290);
  set(Tissue::skin, 420);
  set(Tissue::spleen, 280);
  set(Tissue::fluid, 160);
  set(Tissue::la_blood, 120);
  set(Tissue::arterial_blood, 120);
  set(Tissue::ra_blood, 130);
  set(Tissue::pulmonary_blood, 130);
  set(Tissue::lower_vein, 130);
  set(Tissue::vertebra, 560);
  return value;
}

/// Slowly varying sensitivity of the receive coil, within 12 percent.
void shade(Volume<float>& image) {
  const auto& size = image.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) {
        const double x = static_cast<double>(i) / static_cast<double>(size[0]);
        const double y = static_cast<double>(j) / static_cast<double>(size[1]);
        image(i, j, k) *= static_cast<float>(1 + 0.07 * math::cos(5 * x + 1) + 0.05 * math::cos(4 * y));
      }
}

}  // namespace

void add_torso_mr(Phantom& phantom, int variant) {
  phantom.torso_model = make_heart_model(variant + 1001);
  phantom.torso_mr_landmarks = landmarks_of(phantom.torso_model);
  const auto& anatomy = *phantom.torso_model.anatomy;
  const Grid grid = phantom_grid(phantom.torso_model, {128, 96, 88}, {3, 3, 4});
  auto samples = sample_volume(anatomy, grid);
  auto image = grey_volume(anatomy, samples, mr_values());
  blur(image, 1.5);
  shade(image);
  add_noise(image, 14, 0x3A + static_cast<std::uint64_t>(variant));
  phantom.torso_mr = rounded(image, 0, 4095);
  phantom.torso_mr_labels = std::move(samples.regions);
}

}  // namespace heartgen::phantom
