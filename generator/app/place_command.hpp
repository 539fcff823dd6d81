// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// heartgen place: a heart in another patient's torso, as one label map to build from.
#pragma once
#include <string>

namespace heartgen::app {

struct PlaceCommand {
  std::string heart, torso;                      ///< label maps with our tags
  std::string heart_landmarks, torso_landmarks;  ///< JSON files; may be empty
  std::string output;                            ///< label map to write
  std::string pose;                              ///< JSON file for the pose; may be empty
  bool with_scale = false, json = false;
};

int place_command(const PlaceCommand& command);

}  // namespace heartgen::app
