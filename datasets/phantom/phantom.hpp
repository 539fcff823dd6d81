// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The embedded default data set: an analytic chest CT with exact labels, landmarks and fibres, an MR-like torso of
/// another patient, a carotid angiogram, and the stand-in fibre atlas. Frame LPS mm, direction matrix identity.
/// Deterministic: the same settings give the same bits for any number of threads.
#pragma once
#include <vector>

#include "datasets/phantom/anatomy.hpp"
#include "model/grid.hpp"
#include "model/landmarks.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::phantom {

struct PhantomSettings {
  Index3 size{256, 256, 160};      ///< voxels; each >= 8
  Vec3 spacing_mm{1.4, 1.4, 1.9};  ///< each 0.2 to 10
  int variant = 0;                 ///< >= 0; pose, size, wall thickness, contrast; 0 is the default patient
  double noise_hu = 22;            ///< standard deviation of the CT noise
  double point_spread_mm = 0.6;    ///< standard deviation of the Gaussian point spread; 0: none
  bool companions = true;          ///< also make torso_mr and carotid (otherwise left empty)
  bool fibers = true;              ///< also sample the fibres (otherwise left empty)
  HeartOverrides overrides;
  GreyValues grey;
};

/// Fibres on the grid of the CT: x, y, z components, zero outside ventricular and papillary muscle.
struct FiberGrid {
  Volume<float> x, y, z;
};

struct Phantom {
  HeartModel model;
  CtVolume ct;          ///< HU; the field of view is centred on the heart, shifted to waste no room on air
  LabelVolume labels;   ///< region_at(model, voxel centre) on the CT's grid
  Landmarks landmarks;  ///< LPS mm; seeds for every pool and organ, whether or not the field of view contains them
  FiberGrid fibers;

  HeartModel torso_model;        ///< "another patient": other size, pose and body
  CtVolume torso_mr;             ///< MR-like grey values (fat bright, lung and cortical bone dark)
  LabelVolume torso_mr_labels;   ///< region_at(torso_model, voxel centre)
  Landmarks torso_mr_landmarks;  ///< where the heart belongs in torso_mr: the same names as `landmarks`

  CtVolume carotid;            ///< angiogram with the bifurcation, HU, on its own fine grid
  LabelVolume carotid_labels;  ///< carotid (lumen) and torso
  Vec3 carotid_seed_mm;        ///< in the lumen of the common carotid, in the frame of that image
};

/// Throws UserError for sizes, spacings, noise or variants out of range.
Phantom make_phantom(const PhantomSettings& settings);

/// The grid that `make_phantom` puts around the heart.
Grid phantom_grid(const HeartModel& model, const Index3& size, const Vec3& spacing_mm);

/// Tetrahedral mesh (about 30,000 cells) of two idealised ventricles, cut flat at the base, in a frame of its own, with
/// node_fibers.fiber (helix +60 deg inside to -60 deg outside), regions lv_myocardium and rv_myocardium. Stands in for
/// the fibre atlas where the user has none. `sheet` and `sheet_normal` complete the frame (sheet = transmural).
TetMesh make_standin_atlas();

}  // namespace heartgen::phantom
