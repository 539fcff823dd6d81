// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Every setting of a build, with its unit and default: the user's interface. A recipe is a TOML file; this header
/// is the one place where its keys are declared (numbers about patients stand in tissue.hpp and priors.hpp). `describe`
/// lists the keys of each section, so that reading, checking (unknown keys, wrong types) and writing the resolved
/// recipe all follow from it.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "model/landmarks.hpp"
#include "model/priors.hpp"
#include "model/tissue.hpp"

namespace heartgen {

struct InputSettings {
  std::string ct;           // CT volume: .nii[.gz], .nrrd, .mhd, .mha, or a folder with one DICOM series
  std::string atlas;        // fibre atlas (.vtk, .vtu, .msh, .exnode, images); empty: the built-in stand-in
  std::string labels;       // labels from elsewhere: an image, or a folder with one mask per structure, see [labels]
  std::string label_names;  // names of their values (.csv or .json); empty: those in the file, or the preset's
  std::string landmarks;    // JSON file with seeds and valve planes; the [landmarks] section overrides it
  std::string carotid;      // separate angiogram for the carotid mesh; empty: none
  std::string size_field;   // image of wanted edge lengths (mm) for heart and torso, 0: those of [mesh]; empty: none
  int phase = 0;            // of a CT with several, from 1; 0: it has but one
  std::string atlas_array;  // the array with the fibres in the atlas file; empty: the one with a known name

  template <class V>
  static void describe_files(V&& v, auto& s) {
    v("ct", s.ct, "CT volume: NIfTI, NRRD, MetaImage, or a folder with one DICOM series");
    v("atlas", s.atlas,
      "fibre atlas (.vtk, .vtu, .msh, .exnode, an image of vectors or tensors, a folder of images); empty: stand-in");
    v("labels", s.labels, "labels from elsewhere: an image, or a folder with one mask per structure; see [labels]");
    v("label_names", s.label_names,
      "names of the labels' values (.csv or .json); empty: the file's own or the preset's");
    v("landmarks", s.landmarks, "JSON file with seeds and valve planes");
    v("carotid", s.carotid, "angiogram for the carotid mesh; empty: none");
    v("size_field", s.size_field,
      "image of edge lengths (mm) for the mesh of heart and torso, 0 where those of [mesh] hold; empty: none");
  }
  template <class V>
  static void describe(V&& v, auto& s) {
    describe_files(v, s);
    v("phase", s.phase, "which volume of a CT with several phases, from 1; 0: it has but one");
    v("atlas_array", s.atlas_array,
      "the array with the fibres in an atlas of .vtk, .vtu or .msh; empty: the one with a known name");
  }
};

/// Values (as whole numbers) or structure names of a label map from elsewhere. In a recipe both numbers and texts.
struct LabelKeys {
  std::vector<std::string> keys;
};

/// How `input.labels` is read. What it holds is taken as it is; what it lacks is made by our own stages.
struct LabelSettings {
  std::string preset = "auto";                                        // what values and names mean: see label_presets()
  std::vector<std::string> complete = {"chambers", "walls", "body"};  // groups that our stages complete
  LabelKeys ignore{};                                                 // values or names of no use; "*": all unknown
  std::map<std::string, LabelKeys> regions{};  // region name to values or names; goes before the preset

  template <class V>
  static void describe(V&& v, auto& s) {
    v("preset", s.preset,
      "what values and names mean: a preset, \"auto\" to have it recognised, or \"none\" for [labels.regions] alone");
    v("complete", s.complete, "groups of regions that are made from the CT where the labels lack them");
    v("ignore", s.ignore, "values or names that are of no use; \"*\": all that are unknown");
  }
};

/// Results of stages from files, as `heartgen build --keep-stages` writes them, corrected by hand. A file that was not
/// changed counts as the stage's own result and is not written into the bundle's recipe.
struct ReplaceSettings {
  std::string landmarks;   // landmarks.json
  std::string denoise;     // denoise.nii.gz
  std::string segment;     // segment.json, and the image that it names
  std::string chambers;    // chambers.nii.gz: tags of blood, vessels and papillary muscles
  std::string epicardium;  // epicardium.nii.gz: tags of the walls
  std::string body;        // body.nii.gz: tags of what lies around the heart
  std::string labels;      // labels.nii.gz: the whole label map

  template <class V>
  static void describe(V&& v, auto& s) {
    v("landmarks", s.landmarks, "landmarks.json in place of the automatic landmarks");
    v("denoise", s.denoise, "denoise.nii.gz in place of the smoothed CT");
    v("segment", s.segment, "segment.json (it names its image) in place of the tree of splits");
    v("chambers", s.chambers, "chambers.nii.gz in place of the stage's: blood, great vessels, papillary muscles");
    v("epicardium", s.epicardium, "epicardium.nii.gz in place of the stage's: the walls of the heart");
    v("body", s.body, "body.nii.gz in place of the stage's: torso, lung, bone, liver, trachea");
    v("labels", s.labels, "labels.nii.gz in place of the whole label map");
  }
};

/// Edge-preserving smoothing before segmentation (thesis 3.2, Perona-Malik).
struct DenoiseSettings {
  int iterations = 5;       // explicit steps; 0 switches the stage off
  double time_step = 0.12;  // in units of the smallest voxel spacing squared, stable up to 1/6
  double edge_hu = tissue::soft_tissue_edge_hu;

  template <class V>
  static void describe(V&& v, auto& s) {
    v("iterations", s.iterations, "explicit diffusion steps; 0: no denoising");
    v("time_step", s.time_step, "in units of the smallest squared spacing, at most 1/6");
    v("edge_hu", s.edge_hu, "contrast (HU) at which diffusion falls to a half");
  }
};

/// One two-phase Chan-Vese split of the hierarchy (thesis 5.3, 5.4).
struct SegmentationStep {
  std::string name;            // other steps refer to its sides as "name.above" and "name.below"
  std::string domain = "all";  // "all", or a side of an earlier step
  std::string norm = "L1";     // fidelity: "L1" (medians) or "L2" (means)
  double lambda = 1;           // weight of the fidelity, scaled by the contrast |c1 - c2|
  double mu = 0.1;             // weight of the contour length
  int smoothing = 0;           // steps of the heat equation applied to the image first
  int max_iterations = 100;    // sweeps of the solver

  template <class V>
  static void describe(V&& v, auto& s) {
    v("name", s.name, "name of the step; its sides are name.above and name.below");
    v("domain", s.domain, "\"all\" or a side of an earlier step, such as \"body.above\"");
    v("norm", s.norm, "fidelity: \"L1\" (medians) or \"L2\" (means)");
    v("lambda", s.lambda, "weight of the fidelity");
    v("mu", s.mu, "weight of the contour length");
    v("smoothing", s.smoothing, "steps of the heat equation applied first");
    v("max_iterations", s.max_iterations, "sweeps of the solver at most");
  }
};

/// Which sides of the tree mean what, and how blood is split into chambers (thesis 6.2).
struct ChamberSettings {
  std::string blood = "blood.above";  // side of the tree that holds the contrast-filled blood
  std::string tissue = "body.above";  // side of the tree that is not air
  std::string soft = "soft.above";    // side of the tree that holds muscle (and blood)
  double heart_radius_mm = priors::heart_radius_mm;
  double vessel_length_mm = priors::vessel_length_mm;
  double close_trabeculae_mm = 0;  // closing of the blood pools; 0 keeps papillary muscles and trabeculae
  double minimum_component_ml = priors::papillary_min_ml;
  double vein_stump_mm = priors::vein_stump_mm;
  double cava_stump_radii = priors::cava_stump_radii;
  double papillary_closing_mm = priors::papillary_gap_mm;

  template <class V>
  static void describe(V&& v, auto& s) {
    v("blood", s.blood, "side of the tree that holds the contrast-filled blood");
    v("tissue", s.tissue, "side of the tree that is not air");
    v("soft", s.soft, "side of the tree that holds muscle");
    v("heart_radius_mm", s.heart_radius_mm,
      "the heart is looked for this far from the chambers' centre, and farther if its apex lies far away");
    v("vessel_length_mm", s.vessel_length_mm,
      "great vessels are followed this far from their valves; 0: as far as they reach");
    v("close_trabeculae_mm", s.close_trabeculae_mm, "closing of the blood pools; 0 keeps trabeculae");
    v("minimum_component_ml", s.minimum_component_ml, "smaller pieces of papillary muscle are left to the wall");
    v("vein_stump_mm", s.vein_stump_mm, "veins and appendages stay with their atrium this far from its wide part");
    v("cava_stump_radii", s.cava_stump_radii,
      "venae cavae stay with the right atrium so many of their radii beyond where they have opened to twice their "
      "section");
    v("papillary_closing_mm", s.papillary_closing_mm,
      "muscle in gaps of the left ventricle's blood up to twice this wide, and of the right one's up to once, is "
      "papillary");
  }
};

/// The epicardium as a minimal cut in the band around the cavities (thesis 7.2, problem 7.4, solved as the convex
/// problem it is the steady state of).
struct EpicardiumSettings {
  // The bands: L of thesis 7.2.
  double ventricle_band_mm = priors::lv_band_mm;
  double rv_band_mm = priors::rv_band_mm;
  double atrium_band_mm = priors::atrial_band_mm;
  double muscle_hu = 0;  // the image is clipped here before its gradient is taken; 0: measured
  double edge_hu_per_mm = tissue::epicardial_edge_hu_per_mm;
  double minimum_lv_wall_mm = priors::lv_wall_min_mm;
  double minimum_rv_wall_mm = priors::rv_wall_min_mm;
  double minimum_atrial_wall_mm = priors::atrial_wall_min_mm;
  int max_iterations = 600;
  double duality_gap = 1e-3;  // relative; the solver stops below it

  template <class V>
  static void describe(V&& v, auto& s) {
    v("ventricle_band_mm", s.ventricle_band_mm, "width of the band around the left ventricle's cavity");
    v("rv_band_mm", s.rv_band_mm, "width of the band around the right ventricle's cavity");
    v("atrium_band_mm", s.atrium_band_mm, "width of the band around the atria's cavities");
    v("muscle_hu", s.muscle_hu, "the image is clipped at this grey value before its gradient; 0: measured in the wall");
    v("edge_hu_per_mm", s.edge_hu_per_mm, "gradient at which the edge weight falls to a half");
    v("minimum_lv_wall_mm", s.minimum_lv_wall_mm, "least thickness of the left ventricular wall");
    v("minimum_rv_wall_mm", s.minimum_rv_wall_mm, "least thickness of the right ventricular wall");
    v("minimum_atrial_wall_mm", s.minimum_atrial_wall_mm, "least thickness of the atrial walls");
    v("max_iterations", s.max_iterations, "iterations of the primal-dual solver at most");
    v("duality_gap", s.duality_gap, "relative duality gap at which the solver stops");
  }
};

/// Another patient's body around the heart (thesis 8.3.5), where its CT or its label map is given.
struct TorsoSettings {
  std::string ct;               // CT of the other patient, segmented as the heart's own with this recipe's settings
  std::string labels;           // or its label map, with the tags of a bundle
  std::string landmarks;        // JSON file with its seeds, valves and apex; empty: found in the CT
  bool with_scale = false;      // one scale is fitted too, beside rotation and shift
  std::string frame = "heart";  // frame of the bundle: that of the "heart"'s image or of the "torso"'s
  std::vector<double> torso_from_heart;  // the pose: 3 rows of 4 numbers, mm; empty: fitted to what both have

  bool is_given() const { return !ct.empty() || !labels.empty(); }

  template <class V>
  static void describe_files(V&& v, auto& s) {
    v("ct", s.ct, "CT of another patient whose body goes around the heart; empty: the heart's own body");
    v("labels", s.labels, "or the label map of that patient, with the tags of a bundle");
    v("landmarks", s.landmarks, "JSON file with seeds, valves and apex in that image; empty: found in its CT");
  }
  template <class V>
  static void describe(V&& v, auto& s) {
    describe_files(v, s);
    v("with_scale", s.with_scale, "fit one scale too, beside rotation and shift");
    v("frame", s.frame, "frame of the bundle: the image of the \"heart\", or that of the \"torso\"");
    v("torso_from_heart", s.torso_from_heart,
      "pose as 3 rows of 4 numbers (x = matrix * x + mm); empty: fitted to chambers, valves and apex of both");
  }
};

/// A region of the user's own, painted onto the cells of the heart's walls: scar, fibrosis, an ablation line.
struct RegionSettings {
  std::string file;                // label image (.nii[.gz], .nrrd, .mhd, .mha) or closed surface (.stl, .vtp, .vtk)
  std::vector<std::string> names;  // of its values, ascending; empty: those in the file, or the file's own name

  template <class V>
  static void describe(V&& v, auto& s) {
    v("file", s.file, "label image, or closed surface of triangles (.stl, .vtp, .vtk)");
    v("names", s.names, "of its values, ascending; empty: those in the file, or the file's own name");
  }
};

struct MeshSettings {
  std::string backend = "lattice";  // of the heart and the torso: "lattice", "distmesh", "cgal" or "tetgen"
  std::vector<std::string> meshes = {"myocardium", "chambers", "torso", "trachea", "carotid"};
  double heart_edge_mm = 1.5;          // edge length in the walls of the heart
  int wall_layers = 0;                 // edges from side to side of a thin wall, about; 0: any
  std::vector<double> resolutions_mm;  // further edge lengths, each for one more mesh of the walls alone
  double blood_edge_mm = 4;            // in the chambers, away from the walls
  double torso_edge_mm = 12;           // in the torso, away from the heart
  double trachea_edge_mm = 1.6;
  double carotid_edge_mm = 0.9;
  double smoothing_mm = 0.8;         // the label map is smoothed by this much before surfaces are taken
  double growth = 0.35;              // increase of the edge length per mm of distance from the heart
  std::string insulation = "layer";  // between atria and ventricles: "layer", "split" or "none"

  template <class V>
  static void describe(V&& v, auto& s) {
    v("meshes", s.meshes, "which meshes to make");
    v("backend", s.backend, "mesher of the heart and the torso: \"lattice\", \"distmesh\", \"cgal\" or \"tetgen\"");
    v("heart_edge_mm", s.heart_edge_mm, "edge length in the walls of the heart");
    v("wall_layers", s.wall_layers, "cells across thin walls, 0 (any) to 4: edges there are halved where that helps");
    v("resolutions_mm", s.resolutions_mm, "further edge lengths, each for one more mesh of the walls, 0.4 to 3");
    v("blood_edge_mm", s.blood_edge_mm, "edge length in the chambers, away from the walls");
    v("torso_edge_mm", s.torso_edge_mm, "edge length in the torso, away from the heart");
    v("trachea_edge_mm", s.trachea_edge_mm, "edge length in the trachea");
    v("carotid_edge_mm", s.carotid_edge_mm, "edge length in the carotid");
    v("smoothing_mm", s.smoothing_mm, "smoothing of the label map before surfaces are taken");
    v("growth", s.growth, "increase of the edge length per mm of distance from the heart");
    v("insulation", s.insulation,
      "between atria and ventricles: \"layer\" of cells with regions of their own, \"split\" nodes, or \"none\"");
  }
};

/// Fibres by rule on harmonic coordinates of the mesh: ventricles after Bayer 2012 with the outflow tracts of Doste
/// 2019, both as written by Piersanti 2021, whose angles and thresholds these are (for the atria, its table of an
/// idealised heart). Helix angles: positive as at a normal endocardium; sheet angles: about the fibre, from the wall's
/// normal.
struct RuleSettings {
  double lv_helix_endo_deg = 60;
  double lv_helix_epi_deg = -60;
  double rv_helix_endo_deg = 90;
  double rv_helix_epi_deg = -25;
  double outflow_helix_endo_deg = 90;  // at the aortic and the pulmonary valve
  double outflow_helix_epi_deg = 0;
  double lv_sheet_endo_deg = -20;
  double lv_sheet_epi_deg = 20;
  double rv_sheet_endo_deg = 0;
  double rv_sheet_epi_deg = 20;
  double la_mitral =
      0.65;  // harmonic functions from 0 to 1 between a chamber's openings; bundles begin at these values
  double la_left_veins = 0.1;
  double la_right_veins = 0.65;
  double ra_tricuspid = 0.9;
  double ra_wall = 0.55;
  double ra_inferior_cava = 0.9;
  double ra_superior_cava = 0.1;
  double ra_crista_low = -0.18;
  double ra_crista_high = -0.1;
  double ra_intercaval = 0.135;
  double ra_septum = 0.35;

  template <class V>
  static void describe(V&& v, auto& s) {
    v("lv_helix_endo_deg", s.lv_helix_endo_deg, "helix angle at the left ventricle's endocardium");
    v("lv_helix_epi_deg", s.lv_helix_epi_deg, "helix angle at the left ventricle's epicardium");
    v("rv_helix_endo_deg", s.rv_helix_endo_deg, "helix angle at the right ventricle's endocardium");
    v("rv_helix_epi_deg", s.rv_helix_epi_deg, "helix angle at the right ventricle's epicardium");
    v("outflow_helix_endo_deg", s.outflow_helix_endo_deg, "helix angle inside, at the aortic and the pulmonary valve");
    v("outflow_helix_epi_deg", s.outflow_helix_epi_deg, "helix angle outside, at the aortic and the pulmonary valve");
    v("lv_sheet_endo_deg", s.lv_sheet_endo_deg, "sheet angle at the left ventricle's endocardium");
    v("lv_sheet_epi_deg", s.lv_sheet_epi_deg, "sheet angle at the left ventricle's epicardium");
    v("rv_sheet_endo_deg", s.rv_sheet_endo_deg, "sheet angle at the right ventricle's endocardium");
    v("rv_sheet_epi_deg", s.rv_sheet_epi_deg, "sheet angle at the right ventricle's epicardium");
    v("la_mitral", s.la_mitral, "left atrium: bundle around the mitral valve above this value");
    v("la_left_veins", s.la_left_veins, "left atrium: bundle around the left pulmonary veins below this value");
    v("la_right_veins", s.la_right_veins, "left atrium: bundle around the right pulmonary veins above this value");
    v("ra_tricuspid", s.ra_tricuspid, "right atrium: bundle around the tricuspid valve above this value");
    v("ra_wall", s.ra_wall, "right atrium: roof and back wall below this value");
    v("ra_inferior_cava", s.ra_inferior_cava, "right atrium: bundle around the inferior vena cava above this value");
    v("ra_superior_cava", s.ra_superior_cava, "right atrium: bundle around the superior vena cava below this value");
    v("ra_crista_low", s.ra_crista_low, "right atrium: crista terminalis above this value");
    v("ra_crista_high", s.ra_crista_high, "right atrium: crista terminalis below this value");
    v("ra_intercaval", s.ra_intercaval, "right atrium: intercaval bundle below this value");
    v("ra_septum", s.ra_septum, "right atrium: septum above this value");
  }
};

struct FiberSettings {
  std::string method = "local_angles";  // "local_angles", "coordinates", "jacobian" (thesis 9.2) or "rule"
  double grid_mm = 1.5;                 // spacing of the registration grid
  double demons_sigma_mm = 2;           // smoothing of the displacement field
  std::vector<int> demons_iterations = {60, 40, 15};  // per level, coarse to fine
  int inpainting_iterations = 200;
  double depth_grid_mm = 0.85;  // spacing of the grid for wall depth and directions, at most grid_mm
  RuleSettings rule;            // section [fibers.rule]

  template <class V>
  static void describe(V&& v, auto& s) {
    v("method", s.method,
      "how atlas fibres are carried: \"local_angles\", \"coordinates\" or \"jacobian\"; or \"rule\", without them");
    v("grid_mm", s.grid_mm, "spacing of the registration grid");
    v("demons_sigma_mm", s.demons_sigma_mm, "smoothing of the displacement field");
    v("demons_iterations", s.demons_iterations, "demons iterations per level, coarse to fine");
    v("inpainting_iterations", s.inpainting_iterations, "iterations of the total variation inpainting");
    v("depth_grid_mm", s.depth_grid_mm, "spacing of the grid for wall depth and directions, at most grid_mm");
  }
};

/// Bounds of the certificate that a recipe may change; the others stand in validation/criteria. Where one is broken the
/// bundle is written all the same, and `build` and `validate` exit with 3.
struct ValidationSettings {
  std::vector<std::string> uses;    // what the model must be fit for; empty: what its meshes and edges allow
  double minimum_dihedral_deg = 0;  // 0: what the mesher promises
  double maximum_dihedral_deg = 0;
  double maximum_surface_distance = 1;  // from the label map to the mesh in the heart, 99th percentile, in local edges
  int maximum_handles_added = 2;        // handles of a region of the heart that its label map does not have
  double minimum_jacobian = 0;
  double maximum_inpainted_fraction = 0.5;

  template <class V>
  static void describe(V&& v, auto& s) {
    v("uses", s.uses,
      "what the model must be fit for: eikonal, monodomain, mechanics, ecg, blood_flow, finite_volumes; empty: what "
      "its "
      "meshes and edges allow");
    v("minimum_dihedral_deg", s.minimum_dihedral_deg, "smallest dihedral angle allowed; 0: what the mesher promises");
    v("maximum_dihedral_deg", s.maximum_dihedral_deg, "largest dihedral angle allowed; 0: what the mesher promises");
    v("maximum_surface_distance", s.maximum_surface_distance,
      "from the label map's surfaces to the mesh's in the heart, 99th percentile, in local edge lengths");
    v("maximum_handles_added", s.maximum_handles_added,
      "handles (holes through it) of a region of the heart that its label map does not have");
    v("minimum_jacobian", s.minimum_jacobian, "the warp's Jacobian must exceed this everywhere");
    v("maximum_inpainted_fraction", s.maximum_inpainted_fraction, "share of ventricular nodes without atlas fibres");
  }
};

struct Recipe {
  std::string name = "heart";
  std::string version = "1.0.0";
  std::string license = "CC-BY-4.0";
  std::string author;            // goes into CITATION.cff and RO-Crate
  std::string attribution;       // of the scan and the atlas, as their licences ask
  std::string date_published;    // YYYY-MM-DD; the only date in a bundle
  bool synthetic_image = false;  // the CT is a phantom: the report says so
  InputSettings input;
  LabelSettings labels;
  ReplaceSettings replace;
  Landmarks landmarks;
  DenoiseSettings denoise;
  std::vector<SegmentationStep> segmentation;  // default_segmentation() when the recipe gives none
  ChamberSettings chambers;
  EpicardiumSettings epicardium;
  TorsoSettings torso;
  std::vector<RegionSettings> regions;  // [[regions]]
  MeshSettings mesh;
  FiberSettings fibers;
  ValidationSettings validation;
};

/// The three splits of a contrast CT: air | body, fat | soft tissue, muscle | blood.
std::vector<SegmentationStep> default_segmentation();

/// The bounds of the certificate. Where all fibres are by rule, none from an atlas is no gap. The lattice mesher keeps
/// every angle of several materials within 25 to 145 degrees.
ValidationSettings bounds_of(const Recipe& recipe);

/// Reads and checks a recipe; relative input paths are resolved against the recipe's folder.
/// Throws UserError for a missing file, TOML syntax, unknown keys (with the nearest known one) and wrong types.
Recipe read_recipe(const std::string& path);

/// TOML text with every key written out, in a fixed order, with the meaning of each key as a comment.
/// `file_names_only` drops the folders of the input paths (for the copy inside a bundle).
std::string write_recipe(const Recipe& recipe, bool file_names_only);

/// One section of it ("labels", "replace", "denoise", "segmentation", "chambers", "epicardium", "torso", "mesh",
/// "fibers", "landmarks"): what a stage depends on.
std::string recipe_section(const Recipe& recipe, std::string_view section);

/// Seeds and planes from a JSON file as `heartgen phantom` and `heartgen landmarks` write it.
Landmarks read_landmarks(const std::string& path);
Landmarks parse_landmarks(const std::string& json_text, const std::string& where);
std::string write_landmarks(const Landmarks& landmarks);

/// Throws UserError for seeds and valves of unknown name, and for planes without normal or radius.
void check_landmarks(const Landmarks& landmarks, const std::string& where);

}  // namespace heartgen
