// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/naming_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/phantom/shapes.hpp"
#include "model/crop.hpp"
#include "model/landmarks.hpp"

namespace heartgen::lab {
namespace {

/// What makes one patient, drawn from a seed.
struct Patient {
  phantom::PhantomSettings settings;
  std::uint64_t key = 0, counter = 0;

  Patient(std::uint64_t seed, int n) : key(1000003 * seed + static_cast<std::uint64_t>(n)) {
    settings.size = {128, 128, 90};
    settings.spacing_mm = {2.8, 2.8, 3.4};
    settings.companions = settings.fibers = false;
    settings.variant = static_cast<int>(phantom::random_bits(key, counter++) % 100000) + 1;
    settings.noise_hu = between(10, 30);
    settings.grey.rv = between(180, 380);  // the variant's own may be as grey as muscle
    settings.grey.lv = between(330, 470);
  }
  double between(double low, double high) {
    return 0.5 * (low + high) + 0.5 * (high - low) * phantom::random_symmetric(key, counter++);
  }
  phantom::GreyValues& grey() { return settings.grey; }
};

NamingCase made(const Patient& patient) {
  auto phantom = phantom::make_phantom(patient.settings);
  return {"", fmt::format("variant {}", patient.settings.variant), std::move(phantom.ct), std::move(phantom.model), {}};
}

/// A heart that must be found, of a patient that `change` makes unusual.
template <class Change>
auto heart(Change change) {
  return [change](std::uint64_t seed, int n) {
    Patient patient(seed, n);
    change(patient);
    return made(patient);
  };
}

/// What must be refused: an ordinary patient's image that `spoil` changes.
template <class Spoil>
auto spoiled(std::vector<std::string> reason_words, Spoil spoil) {
  return [reason_words, spoil](std::uint64_t seed, int n) {
    NamingCase c = made(Patient(seed, n));
    spoil(c);
    c.reason_words = reason_words;
    return c;
  };
}

void mirror(CtVolume& ct, std::size_t axis) {
  const CtVolume before = ct;
  const auto& size = ct.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) {
        Index3 from{i, j, k};
        from[axis] = size[axis] - 1 - from[axis];
        ct(i, j, k) = before(from[0], from[1], from[2]);
      }
}

/// The image between two LPS positions along an axis.
void cut(NamingCase& c, int axis, double from_mm, double to_mm) {
  const Grid& grid = c.ct.grid;
  const auto a = static_cast<std::size_t>(axis);
  Box box{{0, 0, 0}, grid.size};
  const auto index = [&](double mm) {
    return std::clamp<std::int64_t>(std::llround((mm - grid.origin_mm[axis]) / grid.spacing_mm[axis]), 0, grid.size[a]);
  };
  box.begin[a] = index(from_mm);
  box.end[a] = index(to_mm);
  c.ct = crop(c.ct, box);
}

Vec3 seed_of(const NamingCase& c, const char* name) { return phantom::landmarks_of(c.model).seeds_mm.at(name); }

constexpr double far_mm = 1e4;

NamingCase heart_only(std::uint64_t seed, int n) {
  NamingCase c = made(Patient(seed, n));
  const Vec3 middle = 0.5 * (seed_of(c, "lv_blood") + seed_of(c, "la_blood"));
  cut(c, 0, middle.x - 105, middle.x + 85);
  cut(c, 1, middle.y - 90, middle.y + 85);
  cut(c, 2, middle.z - 90, middle.z + 100);
  return c;
}

std::vector<CaseKind> all_kinds() {
  const auto& nothing = [](Patient&) {};
  return {
      {"ordinary", heart(nothing)},
      {"noise 45 HU", heart([](Patient& p) { p.settings.noise_hu = 45; })},
      {"turned by up to 25 degrees", heart([](Patient& p) {
         p.settings.overrides.rotation_deg = Vec3{p.between(-25, 25), p.between(-25, 25), p.between(-25, 25)};
       })},
      {"walls and sizes", heart([](Patient& p) {
         p.settings.overrides.lv_wall_mm = p.between(6, 15);
         p.settings.overrides.rv_wall_mm = p.between(2.5, 6);
         p.settings.overrides.scale = p.between(0.85, 1.2);
       })},
      {"all chambers equally bright", heart([](Patient& p) {
         p.grey().lv = p.grey().rv = p.between(300, 450);
         p.grey().svc = *p.grey().lv;
         p.grey().ivc = p.between(150, 300);
       })},
      {"dense contrast in cava and right atrium", heart([](Patient& p) {
         p.grey().lv = p.between(300, 400);
         p.grey().rv = p.between(250, 320);
         p.grey().ra = *p.grey().rv + p.between(80, 160);
         p.grey().pa = *p.grey().rv + 10;
         p.grey().svc = p.between(600, 950);
       })},
      {"jet through unmixed blood", heart([](Patient& p) {
         p.grey().lv = p.between(300, 400);
         p.grey().rv = p.between(230, 320);
         p.grey().ra = p.between(150, 220);
         p.grey().jet = p.between(400, 700);
         p.grey().svc = p.between(600, 950);
         p.grey().ivc = p.between(70, 120);
       })},
      {"pulmonary artery brighter than right ventricle", heart([](Patient& p) {
         p.grey().lv = p.between(350, 450);
         p.grey().rv = p.between(170, 230);
         p.grey().pa = *p.grey().rv + p.between(40, 80);
         p.grey().svc = p.grey().ivc = p.between(90, 150);
       })},
      {"right heart 25 to 45 HU above muscle", heart([](Patient& p) {
         p.settings.noise_hu = p.between(8, 15);
         p.grey().lv = p.between(300, 420);
         p.grey().muscle = p.between(90, 115);
         p.grey().rv = *p.grey().muscle + p.between(25, 45);
         p.grey().svc = p.grey().ivc = p.between(90, 130);
       })},
      {"right heart as grey as muscle", heart([](Patient& p) {
         p.settings.noise_hu = p.between(4, 12);
         p.grey().rv = p.between(85, 118);
         p.grey().svc = p.grey().ivc = p.between(60, 120);
       })},
      {"vertebrae as bright as blood", heart([](Patient& p) {
         p.grey().lv = p.between(250, 320);
         p.grey().rv = p.between(200, 300);
         p.grey().vertebrae = p.between(200, 300);
       })},
      {"field of view around the heart", heart_only},
      {"no contrast",
       [](std::uint64_t seed, int n) {
         Patient p(seed, n);
         p.grey() = phantom::grey_without_contrast();
         p.grey().vertebrae = p.between(200, 300);
         NamingCase c = made(p);
         c.reason_words = {"not brighter", "contrast"};
         return c;
       }},
      {"mirrored", spoiled({"exchanged", "mirror"}, [](NamingCase& c) { mirror(c.ct, 0); })},
      {"upside down", spoiled({"upside", "head", ""}, [](NamingCase& c) { mirror(c.ct, 2); })},
      {"front to back", spoiled({"front", "mirror", "exchanged"}, [](NamingCase& c) { mirror(c.ct, 1); })},
      {"top cut off through the atria",
       spoiled({"top"}, [](NamingCase& c) { cut(c, 2, -far_mm, seed_of(c, "la_blood").z + 5); })},
      {"bottom cut off through the ventricles",
       spoiled({"bottom"}, [](NamingCase& c) { cut(c, 2, seed_of(c, "lv_blood").z - 5, far_mm); })},
      {"left cut off through the ventricle",
       spoiled({"at the left"}, [](NamingCase& c) { cut(c, 0, -far_mm, seed_of(c, "lv_blood").x + 5); })},
  };
}

}  // namespace

const std::vector<CaseKind>& naming_kinds() {
  static const auto kinds = [] {
    auto list = all_kinds();
    for (auto& kind : list)
      kind.draw = [name = kind.name, draw = kind.draw](std::uint64_t seed, int n) {
        NamingCase c = draw(seed, n);
        c.kind = name;
        return c;
      };
    return list;
  }();
  return kinds;
}

}  // namespace heartgen::lab
