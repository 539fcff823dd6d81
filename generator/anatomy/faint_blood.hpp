// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The right heart where contrast hardly reached it: blood a little brighter or darker than muscle, or as bright.
///
/// Two sources are weighed against each other. The grey value: with blood and muscle of known grey values and noise of
/// known power N (HU² mm³), a voxel of grey value g speaks for blood with (b - m) (g - (b + m) / 2) / N nats per mm³.
/// And usual anatomy: the right heart fills the soft tissue inside the epicardial fat, less a free wall, the left
/// ventricle's wall and the thin walls beside the left atrium and the aorta. How thick free wall and septum are is
/// measured first: on average, one number each, for which the grey values of the whole wall speak together, and then
/// from place to place (wall_thickness.hpp).
///
/// The contour is the global minimum of mu (area - ∫ n·N) - ∫ evidence, n its normal and N that of the surfaces
/// parallel to usual anatomy's. The flux of N (Kimmel and Bruckstein 2003) makes mu the price of leaving anatomy's
/// direction, not of curvature: area alone eats thin edges and round caps. By the divergence theorem it is evidence of
/// its own, -mu div N, and the rest is the convex problem of Chan, Esedoglu and Nikolova (2006), solved by total
/// variation of the evidence (its zero level; Chambolle 2005). Where the contrast is good the grey value decides, where
/// there is none the anatomy does.
#pragma once
#include "model/volume.hpp"

namespace heartgen::anatomy {

constexpr double blurred_mm = 1.4;    ///< nearer to fat and bright blood the grey value is a mixture
constexpr double blood_reach_mm = 6;  ///< from the compartment to the farthest blood

/// Distances (mm, 40 at most) from the surfaces that walls are measured from, sub-voxel, 0 behind them; on a grid of
/// equal spacings.
struct WallDistances {
  Volume<float> from_outside;     ///< epicardial fat, lung and air
  Volume<float> from_lv;          ///< blood of the left ventricle, its papillary muscles included
  Volume<float> from_other_left;  ///< other blood of the left heart
  double lv_wall_mm = 0;  ///< usual thickness of the left ventricle's wall, measured where fat or lung is behind
};

/// `lv` is the left ventricle's blood, `other_left` that of left atrium and aorta. What is darker than half-way between
/// fat and muscle is outside.
WallDistances measure_walls(const Volume<float>& hu, const Mask& lv, const Mask& other_left, double muscle_hu);

struct WallThickness {
  double free_mm = 3.5;  ///< free wall of an adult's right ventricle, 3 to 4 mm, and its trabeculae
  double thin_mm = 2;    ///< atria, arteries
  double left_mm = 10;   ///< left ventricle, septum included
  double double_mm = 3;  ///< back to back with the wall of left atrium or aorta
};

/// Usual thicknesses, the left ventricle's as measured where fat or lung is behind.
WallThickness prior_thickness(const WallDistances& walls);

/// How far every voxel lies inside the space that such walls leave to the right heart's blood, mm; negative in the
/// walls. `thin_walled`: atrium and arteries rather than ventricle.
Volume<float> prior_cavity(const WallDistances& walls, const Mask& thin_walled, const WallThickness& thickness);

/// The same for walls of usual thickness.
Volume<float> prior_cavity(const WallDistances& walls, const Mask& thin_walled);

/// Grey values of a faint pool.
struct FaintContrast {
  double muscle_hu = 0;
  double blood_hu = 0;
  double noise_power = 0;  ///< variance of the mean over V mm³ is noise_power / V, HU² mm³
  double difference_hu() const { return blood_hu - muscle_hu; }
};

/// Muscle in the middle of the left ventricle's wall, blood deep inside `space` (prior_cavity) within the compartment.
FaintContrast measure_faint_contrast(const Volume<float>& hu, const WallDistances& walls, const Volume<float>& space,
                                     const Mask& compartment);

/// Nats per mm³ that a grey value speaks for blood, at most 1.
double grey_evidence(float hu, const FaintContrast& contrast);

/// Nats per mm³ by which the mean grey value of blood speaks for blood.
double information(const FaintContrast& contrast);

/// Mean thickness of free wall and septum, the most likely ones for the grey values of what may be wall or blood near
/// the compartment, where no other wall is near; the usual ones (to within a millimetre) where nothing speaks. The thin
/// walls keep theirs: fat and bright blood beside them leave no unmixed grey value.
WallThickness measure_thickness(const Volume<float>& hu, const WallDistances& walls, const Mask& thin_walled,
                                const Mask& compartment, const WallThickness& usual, const FaintContrast& contrast);

/// What is said by `space`: nats per mm³ for muscle outside and for blood inside, growing to that over `slack_mm`.
struct AnatomyTrust {
  double wall_weight = 0.04;    ///< of walls of mean thickness
  double cavity_weight = 0.03;  ///< less: muscles and the valves' rings are inside as well
  double slack_mm = 1;          ///< walls differ from their mean thickness by this
};

/// Of walls measured from place to place: noise that is not alike over a whole neighbourhood must not outvote them.
constexpr AnatomyTrust measured_walls{.wall_weight = 0.15, .cavity_weight = 0.15, .slack_mm = 0.7};

/// Positive in blood, negative elsewhere; the contour is the zero level of its linear interpolation. `compartment`
/// (the right heart's cavities, roughly) bounds the result to 6 mm around it. `trust` holds where walls are `measured`,
/// AnatomyTrust{} elsewhere; an empty mask means everywhere.
Volume<float> faint_blood(const Volume<float>& hu, const WallDistances& walls, const Volume<float>& space,
                          const Mask& compartment, const FaintContrast& contrast, const AnatomyTrust& trust = {},
                          const Mask& measured = {});

/// The same with contours beside thin walls put where the walls' thickness has them, if that is within 0.75 mm; those
/// twice as far off stay, and others move by less. Beside fat or bright blood, grey values speak on the blood's side of
/// the contour only: their noise, and the solver's blur of the large step to where no blood can be, draw the contour
/// inwards by about 0.3 mm.
Volume<float> settle_thin_walls(Volume<float> blood, const Volume<float>& space, const Mask& thin_walled);

}  // namespace heartgen::anatomy
