// The right heart where contrast hardly reached it: blood a little brighter or darker than muscle, or as bright.
//
// Two sources are weighed against each other. The grey value: with blood and muscle of known grey values and noise of
// known power N (HU² mm³), a voxel of grey value g speaks for blood with (b - m) (g - (b + m) / 2) / N nats per mm³.
// And usual anatomy: the right heart fills the soft tissue inside the epicardial fat, less a free wall of usual
// thickness, the left ventricle's wall (as thick towards the septum as it is towards the fat) and the thin walls
// beside the left atrium and the aorta. The contour is the global minimum of mu area - ∫ evidence (Chan, Esedoglu and
// Nikolova 2006), by total variation of the evidence itself (its zero level; Chambolle 2005). Where the contrast is
// good the grey value decides, where there is none the anatomy does.
#pragma once
#include "model/volume.hpp"

namespace heart::segment {

/// Distances (mm) to the surfaces that walls are measured from, on a grid of equal spacings.
struct WallDistances {
  Volume<float> from_outside;     ///< epicardial fat, lung and air
  Volume<float> from_lv;          ///< blood of the left ventricle, its papillary muscles included
  Volume<float> from_other_left;  ///< other blood of the left heart
  double lv_wall_mm = 0;  ///< usual thickness of the left ventricle's wall, measured where fat or lung is behind
};

/// `lv` is the left ventricle's blood, `other_left` that of left atrium and aorta. What is darker than half-way between
/// fat and muscle is outside.
WallDistances measure_walls(const Volume<float>& hu, const Mask& lv, const Mask& other_left, double muscle_hu);

/// How far every voxel lies inside the space that walls of usual thickness leave to the right heart's blood, mm;
/// negative in the walls. `thin_walled`: atrium and arteries rather than ventricle.
Volume<float> usual_cavity(const WallDistances& walls, const Mask& thin_walled);

/// Grey values of a faint pool.
struct FaintContrast {
  double muscle_hu = 0;
  double blood_hu = 0;
  double noise_power = 0;  ///< variance of the mean over V mm³ is noise_power / V, HU² mm³
  double difference_hu() const { return blood_hu - muscle_hu; }
};

/// Muscle in the middle of the left ventricle's wall, blood deep inside `space` (usual_cavity) within the compartment.
FaintContrast measure_faint_contrast(const Volume<float>& hu, const WallDistances& walls, const Volume<float>& space,
                                     const Mask& compartment);

/// Positive in blood, negative elsewhere; the contour is the zero level of its linear interpolation. `compartment`
/// (the right heart's cavities, roughly) bounds the result to 6 mm around it.
Volume<float> faint_blood(const Volume<float>& hu, const WallDistances& walls, const Volume<float>& space,
                          const Mask& compartment, const FaintContrast& contrast);

}  // namespace heart::segment
