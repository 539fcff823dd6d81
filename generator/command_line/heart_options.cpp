// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/command_line/heart_options.hpp"

#include <string>
#include <vector>

namespace heartgen::command_line {

void add_heart_options(CLI::App& command, phantom::HeartOverrides& heart) {
  command.add_option("--lv-wall", heart.lv_wall_mm, "mm, the left ventricle's wall, 5 to 18 (default: the variant's)");
  command.add_option("--rv-wall", heart.rv_wall_mm, "mm, the right ventricle's, 2.5 to 8");
  command.add_option("--heart-size", heart.scale, "over the usual, 0.8 to 1.25");
  const auto turn = [&heart](const std::vector<double>& deg) { heart.rotation_deg = Vec3{deg[0], deg[1], deg[2]}; };
  command
      .add_option_function<std::vector<double>>("--heart-rotation", turn,
                                                "degrees about the patient's axes RX,RY,RZ, each -30 to 30")
      ->delimiter(',')
      ->expected(3);
}

void add_grey_options(CLI::App& command, phantom::GreyValues& grey) {
  const auto set = [&grey](const std::vector<std::string>& assignments) {
    for (const auto& assignment : assignments) phantom::set_grey(grey, assignment);
  };
  auto* hu = command.add_option_function<std::vector<std::string>>(
      "--hu", set,
      "HU of the phantom's parts, as lv=350,rv=300,ra=450,pa=310,svc=900,muscle=105 (others: la, aorta, ivc, "
      "vertebrae; jet: a jet of unmixed contrast through the right atrium; default: the variant's)");
  hu->delimiter(',');
  command
      .add_flag_callback(
          "--no-contrast", [&grey] { grey = phantom::grey_without_contrast(); }, "blood as dark as muscle")
      ->excludes(hu);
}

}  // namespace heartgen::command_line
