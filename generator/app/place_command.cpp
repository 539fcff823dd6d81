// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/place_command.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "generator/adapters/itk_io.hpp"
#include "generator/labels/place_heart.hpp"
#include "generator/pipeline/stage_files.hpp"
#include "model/recipe.hpp"
#include "model/text.hpp"

namespace heartgen::app {
namespace {

using Json = nlohmann::ordered_json;

Landmarks landmarks_from(const std::string& path) { return path.empty() ? Landmarks{} : read_landmarks(path); }

Json pose_json(const labels::TorsoPose& pose, const std::vector<labels::CommonMark>& marks,
               const labels::PlacedHeart& placed) {
  Json out;
  const auto& map = pose.torso_from_heart;
  for (int row = 0; row < 3; ++row)
    out["torso_from_heart"].push_back({map.matrix[row].x, map.matrix[row].y, map.matrix[row].z, map.offset_mm[row]});
  out["scale"] = pose.scale;
  out["rms_mm"] = pose.rms_mm;
  for (std::size_t m = 0; m < marks.size(); ++m) out["residual_mm"][marks[m].name] = pose.residual_mm[m];
  out["outside_share"] = placed.outside_share;
  out["bone_share"] = placed.bone_share;
  return out;
}

}  // namespace

int place_command(const PlaceCommand& command) {
  adapters::check_image_output(command.output);
  if (!command.pose.empty()) check_output(command.pose);
  const auto heart = pipeline::read_region_labels(command.heart), torso = pipeline::read_region_labels(command.torso);
  const auto marks = labels::common_marks(heart, landmarks_from(command.heart_landmarks), torso,
                                          landmarks_from(command.torso_landmarks));
  const auto pose = labels::fit_torso(marks, command.with_scale);
  const auto placed = labels::place_heart(heart, torso, pose);
  adapters::write_volume(command.output, placed.labels);
  const Json out = pose_json(pose, marks, placed);
  if (!command.pose.empty()) write_text(command.pose, out.dump(1) + "\n");
  if (command.json) {
    fmt::print("{}\n", out.dump(1));
    return 0;
  }
  fmt::print("{} common marks, {:.1f} mm apart (root mean square) after the fit; scale {:.3f}\n", marks.size(),
             pose.rms_mm, pose.scale);
  for (std::size_t m = 0; m < marks.size(); ++m)
    fmt::print("  {:<20} {:6.1f} mm\n", marks[m].name, pose.residual_mm[m]);
  fmt::print("of the heart, {:.2f} % lies outside the body and {:.2f} % in bone\n{}\n", 100 * placed.outside_share,
             100 * placed.bone_share, command.output);
  return 0;
}

}  // namespace heartgen::app
