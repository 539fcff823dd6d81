// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/slice_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "generator/parallel/threads.hpp"
#include "model/crop.hpp"
#include "model/labels.hpp"
#include "validation/quantiles.hpp"
#include "validation/report/page_data.hpp"
#include "validation/report/palette.hpp"

namespace heartgen::report {
namespace {

using Json = nlohmann::json;

bool is_chamber_or_wall(std::uint8_t label) {
  const auto r = static_cast<Region>(label);
  return is_myocardium(r) || (is_blood(r) && r != Region::aorta && r != Region::pulmonary_artery);
}

Box heart_box(const LabelVolume& labels) {
  constexpr double margin_mm = 15;
  Box box = bounding_box(labels, 0, is_chamber_or_wall);
  if (box.empty()) box = bounding_box(labels, 0, [](std::uint8_t label) { return label != 0; });
  if (box.empty()) return box;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto margin = static_cast<std::int64_t>(margin_mm / labels.grid.spacing_mm[static_cast<int>(a)]);
    box.begin[a] = std::max<std::int64_t>(box.begin[a] - margin, 0);
    box.end[a] = std::min(box.end[a] + margin, labels.grid.size[a]);
  }
  return box;
}

/// Every step-th voxel of the box; `grid` is that of the voxels taken.
struct Sampling {
  Box box;
  Index3 step{1, 1, 1};
  Grid grid;
};

Sampling sampling_of(const LabelVolume& labels, const Box& box, std::int64_t max_voxels) {
  Sampling s{box, {1, 1, 1}, labels.grid};
  for (double target_mm = 0.7;; target_mm *= 1.1) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double spacing = labels.grid.spacing_mm[static_cast<int>(a)];
      s.step[a] = std::max<std::int64_t>(1, std::lround(target_mm / spacing));
      s.grid.size[a] = (box.end[a] - 1 - box.begin[a]) / s.step[a] + 1;
      s.grid.spacing_mm[static_cast<int>(a)] = spacing * static_cast<double>(s.step[a]);
    }
    if (s.grid.voxel_count() <= max_voxels) break;
  }
  s.grid.origin_mm = lps_from_index(labels.grid, {static_cast<double>(box.begin[0]), static_cast<double>(box.begin[1]),
                                                  static_cast<double>(box.begin[2])});
  return s;
}

template <class Value>
auto sampled(const Sampling& s, Value value) {
  std::vector<decltype(value(Index3{}, Vec3{}))> values(static_cast<std::size_t>(s.grid.voxel_count()));
  parallel::parallel_for(0, s.grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < s.grid.size[1]; ++j)
        for (std::int64_t i = 0; i < s.grid.size[0]; ++i) {
          const Index3 at{s.box.begin[0] + i * s.step[0], s.box.begin[1] + j * s.step[1],
                          s.box.begin[2] + k * s.step[2]};
          const Vec3 own{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          values[static_cast<std::size_t>(s.grid.offset(i, j, k))] = value(at, own);
        }
  });
  return values;
}

/// Mean over the step that begins at a voxel.
float mean_of_step(const CtVolume& ct, const Index3& at, const Index3& step) {
  double sum = 0, count = 0;
  for (auto k = at[2]; k < std::min(at[2] + step[2], ct.grid.size[2]); ++k)
    for (auto j = at[1]; j < std::min(at[1] + step[1], ct.grid.size[1]); ++j)
      for (auto i = at[0]; i < std::min(at[0] + step[0], ct.grid.size[0]); ++i) sum += ct(i, j, k), count += 1;
  return static_cast<float>(sum / count);
}

std::vector<float> grey_values(const CtVolume& ct, const LabelVolume& labels, const Sampling& s) {
  if (ct.grid == labels.grid)
    return sampled(s, [&](const Index3& at, const Vec3&) { return mean_of_step(ct, at, s.step); });
  return sampled(s, [&](const Index3&, const Vec3& own) {
    return static_cast<float>(sample_linear(ct, index_from_lps(ct.grid, lps_from_index(s.grid, own))));
  });
}

/// Grey values that the page can tell apart.
struct GreyRange {
  double low_hu = -250, high_hu = 600;
};

/// Fat to a little above the brightest common blood, so that contrast shows its structure in any protocol.
Json window_json(const std::vector<float>& grey, const std::vector<std::uint8_t>& labels, const GreyRange& range) {
  constexpr double low_hu = -180, min_high_hu = 300;
  std::vector<double> blood;
  for (std::size_t v = 0; v < grey.size(); ++v)
    if (is_blood(static_cast<Region>(labels[v]))) blood.push_back(grey[v]);
  const double high_hu = std::clamp(1.1 * validation::quantile(std::move(blood), 0.9), min_high_hu, range.high_hu);
  return {{"level", std::round((low_hu + high_hu) / 2)}, {"width", std::round(high_hu - low_hu)}};
}

GreyRange range_of(const std::vector<float>& grey) {
  constexpr double max_hu = 1500;
  GreyRange range;
  const double bright = validation::quantile({grey.begin(), grey.end()}, 0.999);
  range.high_hu = std::clamp(std::ceil(bright / 50) * 50, range.high_hu, max_hu);
  return range;
}

/// As differences along i: noise aside, neighbours are alike.
void append_grey(Blob& blob, const std::vector<float>& grey, std::int64_t row, const GreyRange& range) {
  std::uint8_t before = 0;
  for (std::size_t v = 0; v < grey.size(); ++v) {
    if (v % static_cast<std::size_t>(row) == 0) before = 0;
    const double share = std::clamp((grey[v] - range.low_hu) / (range.high_hu - range.low_hu), 0.0, 1.0);
    const auto value = static_cast<std::uint8_t>(std::lround(255 * share));
    blob.bytes.push_back(static_cast<std::uint8_t>(value - before));
    before = value;
  }
}

Json regions_json(const std::vector<std::uint8_t>& labels) {
  std::array<bool, 256> present{};
  for (const auto label : labels) present[label] = true;
  Json json = Json::array();
  for (std::int32_t r = 1; r < 256; ++r) {
    if (!present[static_cast<std::size_t>(r)]) continue;
    std::string label = region_name(r);
    std::replace(label.begin(), label.end(), '_', ' ');
    const Rgb c = region_color(r);
    json.push_back({{"tag", r}, {"label", label}, {"color", {c.r, c.g, c.b}}});
  }
  return json;
}

Json vec_json(const Vec3& v) { return {v.x, v.y, v.z}; }

}  // namespace

SliceData slice_data(const CtVolume* ct, const LabelVolume& labels, std::int64_t max_voxels) {
  SliceData data;
  const Box box = heart_box(labels);
  if (box.empty()) return data;
  data.empty = false;
  const Sampling s = sampling_of(labels, box, max_voxels);
  const auto regions = sampled(s, [&](const Index3& at, const Vec3&) { return labels(at[0], at[1], at[2]); });
  Blob blob;
  Json index = {
      {"size", s.grid.size}, {"spacing", vec_json(s.grid.spacing_mm)}, {"origin", vec_json(s.grid.origin_mm)}};
  for (int row = 0; row < 3; ++row) index["direction"].push_back(vec_json(s.grid.direction[row]));
  if (ct != nullptr) {
    data.has_ct = true;
    const auto grey = grey_values(*ct, labels, s);
    const GreyRange range = range_of(grey);
    index["hu"] = {range.low_hu, range.high_hu};
    index["window"] = window_json(grey, regions, range);
    index["grey"] = blob.start();
    append_grey(blob, grey, s.grid.size[0], range);
  }
  index["labels"] = blob.start();
  blob.bytes.insert(blob.bytes.end(), regions.begin(), regions.end());
  index["regions"] = regions_json(regions);
  data.index_json = index.dump();
  data.data_base64 = deflated_base64(blob.bytes);
  return data;
}

}  // namespace heartgen::report
