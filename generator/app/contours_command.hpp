// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen contours`: deformable contours on an image.
#pragma once
#include <string>
#include <vector>

#include "generator/parallel/comm.hpp"

namespace heartgen::app {

struct ContoursCommand {
  std::string method;          ///< snake, geometric, geodesic or subjective
  std::string input, output;   ///< image in; mask (1 inside) out
  std::string surface;         ///< also write φ (geometric, geodesic: mm, negative inside; subjective: high inside)
  std::vector<double> seeds;   ///< x, y, z, x, y, z, ... LPS mm
  double start_radius_mm = 5;  ///< of the start around the seeds
  double smoothing_mm = 1;
  double edge_per_mm = 0;  ///< 0: default_edge_per_mm
  double curvature_mm = 1, attraction_mm = -1, balloon = 0;
  double tension_mm = 0.3, rigidity_mm3 = 1;
  double share = 0.5;   ///< subjective: level of the object's border, of the plateau at the seeds
  int iterations = -1;  ///< -1: the method's default
  bool json = false;
};

/// @collective (snakes run on the root)
int contours_command(const ContoursCommand& command, const parallel::Comm& comm);

}  // namespace heartgen::app
