// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The body around the heart: skin, chest wall, lungs, airways, spine, abdomen; and the whole anatomy of one patient.
#pragma once
#include <array>

#include "datasets/phantom/anatomy.hpp"
#include "datasets/phantom/heart_shapes.hpp"

namespace heartgen::phantom {

/// Shapes of the body. Everything analytic is written for a template thorax (x = 0 in the mid-sagittal plane) and
/// stretched by `stretch`; tubes are stored in patient mm.
struct BodyShapes {
  Vec3 stretch{1, 1, 1};
  HeightTable skin_half_width, skin_front, skin_back;        ///< template mm over template z
  HeightTable cavity_half_width, cavity_front, cavity_back;  ///< inner chest and abdominal wall
  HeightTable spine_y;                                       ///< centre of the vertebral bodies
  Tube airway, airway_branches, esophagus, carotids, arch_branches, veins;
  Tube lung_arteries, lung_veins, clavicles, limbs;
  double fat_mm = 11;  ///< subcutaneous fat
};

struct Anatomy {
  HeartPose pose;
  HeartShapes heart;
  BodyShapes body;
  std::optional<Tube> jet;               ///< of unmixed contrast in the right atrium
  std::array<float, tissue_count> hu{};  ///< mean CT number per tissue
};

struct Sample {
  Region region = Region::none;
  Tissue tissue = Tissue::air;
};

/// Smoothly bends template points towards the patient: like the heart near it, like the thorax far from it.
Vec3 place_in_patient(const HeartPose& pose, const Vec3& stretch, const Vec3& q);

BodyShapes make_body_shapes(const HeartPose& pose, const Vec3& stretch, const HeartShapes& heart);

/// Classifies a point inside the skin that is neither heart nor great vessel; `skin` is its skin_distance.
Sample body_sample(const BodyShapes& body, const HeartShapes& heart, const HeartField& field, const Vec3& p,
                   double skin);

/// Negative inside the skin (mm, first order).
double skin_distance(const BodyShapes& body, const Vec3& p);

Sample sample_at(const Anatomy& anatomy, const Vec3& p);

}  // namespace heartgen::phantom
