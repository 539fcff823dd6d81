// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Numbers about patients: how large, thick and far apart the parts of an adult's body are. docs/numbers.md is their
/// table.
#pragma once
#include "model/number.hpp"

namespace heartgen {
namespace priors {

// Heart.
inline constexpr Number heart_radius_mm =
    number("heart_radius_mm", 85, "mm", 70, 110,
           "The heart is looked for this far from the chambers' centre (chambers.heart_radius_mm)");
inline constexpr Number vessel_length_mm =
    number("vessel_length_mm", 45, "mm", 20, 100,
           "Aorta and pulmonary artery are followed this far from their valves (chambers.vessel_length_mm)",
           Basis::reasoning, "The part of them that a model of the heart holds: a choice, not a size");
inline constexpr Number vein_stump_mm =
    number("vein_stump_mm", 15, "mm", 5, 30,
           "Veins and appendages stay with their atrium this far from its wide part (chambers.vein_stump_mm)",
           Basis::reasoning, "The part of them that a model of the heart holds: a choice, not a size");
inline constexpr Number cava_stump_radii =
    number("cava_stump_radii", 1.5, "1", 0.5, 3,
           "Venae cavae stay with the right atrium so many of their radii (chambers.cava_stump_radii)",
           Basis::reasoning, "The part of them that a model of the heart holds: a choice, not a size");
inline constexpr Number papillary_gap_mm = number(
    "papillary_gap_mm", 12, "mm", 6, 16,
    "Half the width of gaps in the left ventricle's blood whose muscle is papillary (chambers.papillary_closing_mm)",
    Basis::unrecorded,
    "Not recorded; kobashi1998: papillary muscles are 7 +- 2 mm wide, hypertrophic ones more than 11");
inline constexpr Number papillary_min_ml =
    number("papillary_min_ml", 0.1, "ml", 0.02, 0.5,
           "Smaller pieces of papillary muscle are wall (chambers.minimum_component_ml)");
inline constexpr Number lv_band_mm =
    number("lv_band_mm", 22, "mm", 15, 35,
           "The left ventricle's wall is looked for this far from its blood (epicardium.ventricle_band_mm)",
           Basis::paper, "elliott2014: walls beyond 15 mm are hypertrophic, 30 mm is massive");
inline constexpr Number rv_band_mm =
    number("rv_band_mm", 10, "mm", 6, 15,
           "The right ventricle's wall is looked for this far from its blood (epicardium.rv_band_mm)", Basis::paper,
           "rudski2010: beyond 5 mm it is hypertrophic; twice that");
inline constexpr Number atrial_band_mm =
    number("atrial_band_mm", 5, "mm", 3, 8,
           "The atria's walls are looked for this far from their blood (epicardium.atrium_band_mm)", Basis::paper,
           "whitaker2021: the left atrium's has 1.45 mm in the median, most at the septum");
inline constexpr Number lv_wall_min_mm = number(
    "lv_wall_min_mm", 3, "mm", 2, 6, "Least thickness of the left ventricle's wall (epicardium.minimum_lv_wall_mm)",
    Basis::paper,
    "kawel2012: 5.3 +- 0.9 and 6.3 +- 1.1 mm at half height in women and men at end diastole: less two deviations");
inline constexpr Number rv_wall_min_mm = number(
    "rv_wall_min_mm", 2, "mm", 1, 4, "Least thickness of the right ventricle's wall (epicardium.minimum_rv_wall_mm)",
    Basis::unrecorded, "Not recorded; rudski2010 gives the upper limit alone");
inline constexpr Number atrial_wall_min_mm = number(
    "atrial_wall_min_mm", 1.5, "mm", 1, 2.5, "Least thickness of the atria's walls (epicardium.minimum_atrial_wall_mm)",
    Basis::paper, "whitaker2021: the left atrium's has 1.45 mm in the median");
inline constexpr Number lv_muscle_from_mm =
    number("lv_muscle_from_mm", 2, "mm", 1, 4, "The left wall's muscle is measured this far from the blood");
inline constexpr Number lv_muscle_to_mm =
    number("lv_muscle_to_mm", 6, "mm", 4, 8, "And no farther than this from the blood", Basis::unrecorded,
           "Not recorded; kawel2012: 5.3 to 6.3 mm");
inline constexpr Number given_muscle_from_mm =
    number("given_muscle_from_mm", 3, "mm", 1, 4, "The left wall's muscle is measured from this far beside given blood",
           Basis::unrecorded, "Not recorded; could be lv_muscle_from_mm: changes which gaps are closed");
inline constexpr Number given_muscle_to_mm =
    number("given_muscle_to_mm", 7, "mm", 4, 8, "And to this far beside given blood", Basis::unrecorded,
           "Not recorded; could be lv_muscle_to_mm: changes which gaps are closed");
inline constexpr Number lv_surroundings_mm =
    number("lv_surroundings_mm", 5, "mm", 3, 8, "No other organ lies nearer to the left ventricle's blood",
           Basis::unrecorded, "Not recorded; kawel2012: walls of 5.3 to 6.3 mm");
inline constexpr Number wall_reach_mm =
    number("wall_reach_mm", 12, "mm", 8, 20, "Distances to surfaces are exact this far off: as far as walls are thick");
inline constexpr Number lv_to_rv_volume_max =
    number("lv_to_rv_volume_max", 8, "1", 4, 12, "No heart has ventricles of which one is so many times the other");
inline constexpr Number la_to_lv_volume_max =
    number("la_to_lv_volume_max", 20, "1", 10, 40,
           "No heart has a left atrium and ventricle of which one is so many times the other");
inline constexpr Number ra_to_rv_volume_max =
    number("ra_to_rv_volume_max", 20, "1", 10, 40,
           "No heart has a right atrium and ventricle of which one is so many times the other");
inline constexpr Number marks_width_min_mm =
    number("marks_width_min_mm", 5, "mm", 2, 15,
           "Common marks of a heart and a torso span a plane if they are so far off a line");

// Valves and vessels.
inline constexpr Number smallest_valve_mm2 =
    number("smallest_valve_mm2", 100, "mm2", 60, 150, "No valve's section or contact is smaller", Basis::paper,
           "lang2015: the aortic annulus is 2.3 +- 0.2 cm wide in women, 415 mm2; a quarter of it");
inline constexpr Number mitral_open_mm2 = number(
    "mitral_open_mm2", 400, "mm2", 200, 500, "A mitral valve is closed below this contact of atrium and ventricle",
    Basis::paper, "naoum2016: 4.7 +- 0.6 cm2 per m2 of body surface, 8 cm2: half of it");
inline constexpr Number aortic_open_mm2 =
    number("aortic_open_mm2", 200, "mm2", 100, 250, "An aortic valve is closed below this contact", Basis::paper,
           "lang2015: annuli 2.3 to 2.6 cm wide, 4 to 5 cm2: half of it");
inline constexpr Number tricuspid_open_mm2 =
    number("tricuspid_open_mm2", 500, "mm2", 250, 600, "A tricuspid valve is closed below this contact", Basis::paper,
           "tei1982: 11.3 +- 1.8 cm2: half of it");
inline constexpr Number pulmonary_open_mm2 =
    number("pulmonary_open_mm2", 200, "mm2", 100, 250, "A pulmonary valve is closed below this contact", Basis::paper,
           "westaby1984: 4.3 +- 1.0 and 4.9 +- 1.3 cm2 in women and men: half of it");
inline constexpr Number valve_plate_mm =
    number("valve_plate_mm", 3, "mm", 1, 5,
           "The fibrous plate of the valves, with the muscle that carries it, reaches this far");
inline constexpr Number valve_gap_max_mm =
    number("valve_gap_max_mm", 6, "mm", 3, 10,
           "Masks of great vessels end this far from their ventricle: at the sinuses, not at the valve");
inline constexpr Number artery_wall_mm =
    number("artery_wall_mm", 2, "mm", 1.2, 2.8, "The wall of the aorta and the pulmonary artery", Basis::paper,
           "mensel2014: 1.46 (1.15 to 1.88) and 1.56 (1.22 to 1.99) mm in women and men; turkbey2014: 2.8 mm");
inline constexpr Number artery_lead_mm =
    number("artery_lead_mm", 3, "mm", 1, 5,
           "Away from its valve an artery's wall gets only what is so much nearer to it than to a chamber");
inline constexpr Number other_vessel_radius_mm =
    number("other_vessel_radius_mm", 2.5, "mm", 1.5, 4,
           "Unlabelled blood thicker than this is a vein or an artery, no coronary", Basis::paper,
           "dodge1992: the left main coronary artery is 4.5 +- 0.5 mm wide, the others are thinner");
inline constexpr Number vein_section_min_mm2 =
    number("vein_section_min_mm2", 80, "mm2", 40, 150, "Smaller sections beside the right atrium are no vena cava",
           Basis::unrecorded, "Not recorded; the lower one is 17 by 26 mm (PubMed 36579206), 350 mm2");
inline constexpr Number vein_max_widening = number(
    "vein_max_widening", 1.5, "1", 1.2, 2, "A vena cava's section grows no more over 8 mm; what does is other tissue");
inline constexpr Number vein_min_upright =
    number("vein_min_upright", 0.7, "1", 0.5, 0.9, "Cosine of a vena cava's axis and the vertical, at least");
inline constexpr Number cava_beside_atrium_mm =
    number("cava_beside_atrium_mm", 10, "mm", 5, 20, "A vena cava lies no farther beside the right atrium");
inline constexpr Number cava_above_atrium_mm = number(
    "cava_above_atrium_mm", 10, "mm", 5, 20, "The upper vena cava is looked at this far above the atrium's wide part");
inline constexpr Number cava_below_atrium_mm = number(
    "cava_below_atrium_mm", 4, "mm", 2, 10, "The lower vena cava is looked at this far below the atrium's wide part");
inline constexpr Number artery_piece_min_mm3 =
    number("artery_piece_min_mm3", 50, "mm3", 20, 200, "Smaller pieces of an artery's end are noise");
inline constexpr Number great_vessel_piece_min_mm3 = number("great_vessel_piece_min_mm3", 1000, "mm3", 300, 3000,
                                                            "Given pieces of a great vessel stay if they are larger");
inline constexpr Number ventricles_cut_max_cm2 =
    number("ventricles_cut_max_cm2", 3, "cm2", 1, 8, "The field of view may cut the ventricles over so much",
           Basis::reasoning, "A whole section has 15 cm2 and more");
inline constexpr Number carotid_max_ml =
    number("carotid_max_ml", 60, "ml", 20, 100, "More is a leak into something else");
inline constexpr Number carotid_section_min_mm2 = number(
    "carotid_section_min_mm2", 1.5, "mm2", 1, 5, "Smaller sections of a carotid have no room for a snake",
    Basis::unrecorded, "Not recorded; baz2021: the internal carotid is 4.7 +- 0.5 mm wide where it leaves the neck");

// Lungs and airways.
inline constexpr Number lung_share =
    number("lung_share", 0.1, "1", 0.03, 0.3,
           "Of the largest air space in the body: smaller ones are airways, stomach and bowel");
inline constexpr Number lung_min_ml =
    number("lung_min_ml", 20, "ml", 5, 100, "Smaller pieces of lung are airways and gas");
inline constexpr Number lung_section_min_mm2 =
    number("lung_section_min_mm2", 1000, "mm2", 500, 3000, "The hull of less lung in a slice says little");
inline constexpr Number lung_vessel_radius_mm =
    number("lung_vessel_radius_mm", 2.5, "mm", 1.5, 5, "Thinner vessels count as lung");
inline constexpr Number lung_beside_bone_mm =
    number("lung_beside_bone_mm", 4, "mm", 2, 8,
           "A piece of bone is looked at from so far: a vessel of the lung sees lung all round");
inline constexpr Number pleura_mm = number("pleura_mm", 3, "mm", 1.5, 5, "Blurred rim between lung and chest wall");
inline constexpr Number chest_wall_max_mm =
    number("chest_wall_max_mm", 60, "mm", 30, 100, "No chest wall is thicker", Basis::paper,
           "givens2004: 42 mm in the mean between the second and the third rib, a quarter of them beyond 50");
inline constexpr Number airways_max_ml =
    number("airways_max_ml", 120, "ml", 60, 200, "Trachea and bronchi have less; more is a leak into the lung",
           Basis::paper, "kamel2009: the trachea alone has 35.6 +- 6.8 and 24.7 +- 6.1 ml in men and women");
inline constexpr Number trachea_section_min_mm2 =
    number("trachea_section_min_mm2", 60, "mm2", 40, 100, "Smallest section of a trachea", Basis::paper,
           "breatnach1984: diameters from 10 mm on in women: 79 mm2");
inline constexpr Number trachea_section_max_mm2 =
    number("trachea_section_max_mm2", 900, "mm2", 450, 1200, "Largest section of a trachea", Basis::paper,
           "breatnach1984: at most 25 and 27 mm wide in men: 530 mm2, which leaves room for a wide one");
inline constexpr Number trachea_roundness_min =
    number("trachea_roundness_min", 0.75, "1", 0.6, 0.9, "Of a trachea's section, against a disc");
inline constexpr Number trachea_section_change_max =
    number("trachea_section_change_max", 2, "1", 1.3, 3, "Of a trachea's section from slice to slice, as a ratio");
inline constexpr Number trachea_drift_max_mm =
    number("trachea_drift_max_mm", 5, "mm", 2, 10, "Of a trachea's middle from slice to slice");
inline constexpr Number trachea_length_min_mm =
    number("trachea_length_min_mm", 20, "mm", 10, 60, "A trachea runs so far through the slices", Basis::paper,
           "kamel2009: 105.1 +- 9.8 and 98.3 +- 8.7 mm long; an image may cut it");
inline constexpr Number airway_rim_mm =
    number("airway_rim_mm", 3, "mm", 1.5, 5, "Beside the wide airways nothing tells a leak from their own rim");
inline constexpr Number airway_wall_max_mm =
    number("airway_wall_max_mm", 2.5, "mm", 1, 4, "From the lumen to the crest of the airways' wall", Basis::unrecorded,
           "Not recorded; a review (MDCT of the central airways, Applied Radiology) says that tracheas have walls of 1 "
           "to 3 mm");
inline constexpr Number bronchus_max_radius_mm =
    number("bronchus_max_radius_mm", 3.5, "mm", 2, 6, "Of a bronchus that the wide airways may lack");
inline constexpr Number bronchi_max_share =
    number("bronchi_max_share", 0.4, "1", 0.2, 0.8,
           "Of the wide airways' volume; a lung's visible bronchi hold some 0.1 to 0.2");
inline constexpr Number lung_beside_airways_min_ml =
    number("lung_beside_airways_min_ml", 1, "ml", 0.3, 5, "Less is no lung beside the airways");

// Bone and body.
inline constexpr Number patient_min_mm =
    number("patient_min_mm", 2, "mm", 1, 50, "No image of a patient is narrower: its lengths are in another unit");
inline constexpr Number patient_max_mm = number("patient_max_mm", 10000, "mm", 3000, 20000,
                                                "No image of a patient is wider: its lengths are in another unit");
inline constexpr Number table_contact_mm =
    number("table_contact_mm", 4, "mm", 2, 8, "The scanner's table touches the skin in pieces thinner than twice this");
inline constexpr Number padding_wall_mm =
    number("padding_wall_mm", 12, "mm", 8, 20, "Thickness of what closes a body that the image cuts", Basis::reasoning,
           "More than twice table_contact_mm, or the body would not be found behind it");
inline constexpr Number vessel_bone_contact_mm =
    number("vessel_bone_contact_mm", 2, "mm", 1, 4, "Vessels and bones that touch over less than twice this are apart");
inline constexpr Number organ_rim_mm = number("organ_rim_mm", 2, "mm", 1, 4, "Off their surface organs are even");
inline constexpr Number organ_outer_rim_mm =
    number("organ_outer_rim_mm", 2.5, "mm", 1, 4, "The rest of an even organ lies within this of its even inside");
inline constexpr Number even_organ_min_ml =
    number("even_organ_min_ml", 2, "ml", 0.5, 5, "Smaller even spots are marrow");
inline constexpr Number metal_rim_mm = number("metal_rim_mm", 2.5, "mm", 1, 5, "The bright rim around metal");
inline constexpr Number marrow_gap_mm =
    number("marrow_gap_mm", 3, "mm", 1.5, 5, "Marrow in gaps of bone up to twice this wide belongs to it");
inline constexpr Number bone_skin_mm =
    number("bone_skin_mm", 2.2, "mm", 1, 4, "The blurred outside of bone is no thicker");
inline constexpr Number cortex_distance_mm =
    number("cortex_distance_mm", 2.5, "mm", 1, 4, "A bone's shell is this near to its blurred outside");
inline constexpr Number bone_piece_min_ml =
    number("bone_piece_min_ml", 0.5, "ml", 0.1, 2, "Smaller pieces are no bone");
inline constexpr Number spinal_canal_radius_min_mm =
    number("spinal_canal_radius_min_mm", 3, "mm", 2, 6,
           "The canal is wider; the ways of veins and nerves out of it are narrower", Basis::paper,
           "kang2012: 14.6 +- 1.3 mm from front to back at the eighth thoracic vertebra");
inline constexpr Number spinal_canal_to_bone_max_mm =
    number("spinal_canal_to_bone_max_mm", 20, "mm", 12, 30, "Bone around the canal is nearer to its middle line");
inline constexpr Number spinal_canal_length_min_mm =
    number("spinal_canal_length_min_mm", 50, "mm", 30, 100, "Two vertebrae, so that one level between them is passed");
inline constexpr Number liver_max_ml =
    number("liver_max_ml", 2800, "ml", 2000, 4000, "More is a leak into other soft tissue", Basis::paper,
           "kromrey2018: 1505 +- 385 ml, with a diseased liver 1624 +- 420: three deviations more");
inline constexpr Number liver_min_ml =
    number("liver_min_ml", 50, "ml", 20, 300, "Less of a liver is not taken for one");
inline constexpr Number liver_vessel_radius_mm =
    number("liver_vessel_radius_mm", 3, "mm", 1.5, 6, "Vessels inside the liver are brighter; they belong to it");
inline constexpr Number liver_under_lung_mm =
    number("liver_under_lung_mm", 80, "mm", 40, 150, "The liver's thickest place lies no deeper below the right lung");
inline constexpr Number liver_depth_min_mm =
    number("liver_depth_min_mm", 18, "mm", 10, 40, "The liver's thickest place lies so far inside it");
inline constexpr Number liver_right_share_min =
    number("liver_right_share_min", 0.7, "1", 0.5, 0.9, "Of the liver lies right of the lungs' middle");

// Ventricles, atlas and fibres.
inline constexpr Number inlet_rim_mm =
    number("inlet_rim_mm", 12, "mm", 6, 20, "Muscle ends at the plate of an inlet this far beside its orifice");
inline constexpr Number plate_rim_mm =
    number("plate_rim_mm", 30, "mm", 15, 45,
           "Muscle ends at the plate of an inlet this far beside its orifice where it lies low above it");
inline constexpr Number plate_height_mm =
    number("plate_height_mm", 6, "mm", 3, 10, "Where muscle lies lower above the plate than this, plate_rim_mm holds");
inline constexpr Number root_rim_mm =
    number("root_rim_mm", 4, "mm", 2, 8, "Muscle ends at an arterial root this far beside its lumen");
inline constexpr Number outflow_height_mm =
    number("outflow_height_mm", 8, "mm", 4, 15, "A cut ventricle's outlet lies so much below the cut");
inline constexpr Number plate_ring_from_mm = number(
    "plate_ring_from_mm", 2, "mm", 1, 4, "An inlet lies in a plate: blood is sought in a ring from here beside it");
inline constexpr Number plate_ring_to_mm = number("plate_ring_to_mm", 5, "mm", 3, 8, "And to here beside it");
inline constexpr Number plate_ring_top_mm = number(
    "plate_ring_top_mm", -5, "mm", -8, -2, "The ring of plate_ring_from_mm begins at this height over the orifice");
inline constexpr Number plate_ring_bottom_mm =
    number("plate_ring_bottom_mm", -8, "mm", -12, -5, "And ends at this one");
inline constexpr Number lv_section_min_mm2 = number("lv_section_min_mm2", 115, "mm2", 50, 300,
                                                    "Smaller sections of the left ventricle do not count for its axis");
inline constexpr Number trabecula_max_mm =
    number("trabecula_max_mm", 6, "mm", 3, 10, "Trabeculae are looked for this far from the endocardium");
inline constexpr Number trabeculae_off_base_mm = number(
    "trabeculae_off_base_mm", 9, "mm", 4, 15, "No trabeculae this near to the base, where a wall's surfaces end");
inline constexpr Number wall_straightens_mm =
    number("wall_straightens_mm", 10, "mm", 5, 20, "Above a cut, walls straighten over so much");
inline constexpr Number wall_end_mm = number("wall_end_mm", 14, "mm", 8, 20, "As far as a wall's ends change it");
inline constexpr Number thick_wall_mm =
    number("thick_wall_mm", 6, "mm", 4, 8, "Thicker walls have voxels enough across for a quadratic continuation",
           Basis::unrecorded, "Not recorded; between the right wall (rudski2010: up to 5 mm) and the left one");
inline constexpr Number clear_of_valves_mm = number(
    "clear_of_valves_mm", 6, "mm", 3, 10, "This far from valves and roots a ventricle's wall has surfaces of its own");
inline constexpr Number clear_of_left_mm = number(
    "clear_of_left_mm", 5, "mm", 3, 10, "This far from the left ventricle the right wall's surfaces are its own");
inline constexpr Number uneven_wall_from_mm =
    number("uneven_wall_from_mm", 0.8, "mm", 0.4, 1.5,
           "A left wall that is so much off a smooth one changes too fast for a fit");
inline constexpr Number uneven_wall_to_mm =
    number("uneven_wall_to_mm", 1.6, "mm", 0.8, 3,
           "A left wall that is so much off a smooth one surely changes too fast for a fit");
inline constexpr Number left_wall_to_valve_mm = number(
    "left_wall_to_valve_mm", 8, "mm", 4, 12, "Beyond this distance from what lies at its end the left wall is compact");
inline constexpr Number right_wall_to_valve_mm =
    number("right_wall_to_valve_mm", 4, "mm", 2, 8,
           "Beyond this distance from what lies at its end the right wall is compact");
inline constexpr Number outflow_tract_mm =
    number("outflow_tract_mm", 2, "mm", 1, 4, "Beyond the wall's thickness, where the outflow tract's blood goes on");
inline constexpr Number left_end_mm =
    number("left_end_mm", 5, "mm", 2, 8, "A thick wall's surfaces bend this near to its end");
inline constexpr Number right_end_mm =
    number("right_end_mm", 2, "mm", 1, 4, "A thin wall's surfaces bend this near to its end");
inline constexpr Number right_end_thicknesses =
    number("right_end_thicknesses", 0.7, "1", 0.3, 1.5, "And so many of the wall's thicknesses farther");
inline constexpr Number heart_min_mm =
    number("heart_min_mm", 50, "mm", 30, 70, "The longest side of a pair of ventricles, of a small animal or a child");
inline constexpr Number heart_max_mm =
    number("heart_max_mm", 250, "mm", 180, 300, "The longest side of a pair of ventricles, of a large man");
inline constexpr Number adult_heart_rms_mm =
    number("adult_heart_rms_mm", 38, "mm", 30, 45,
           "Root mean square distance of an adult's ventricular muscle from its centre");
inline constexpr Number cavity_min_ml =
    number("cavity_min_ml", 5, "ml", 2, 20, "Smaller cavities of an atlas are no ventricle");
inline constexpr Number atlas_mixing_max_mm = number(
    "atlas_mixing_max_mm", 15, "mm", 5, 20, "Beyond this from where its walls join an atlas mixes no directions");
inline constexpr Number wall_junction_mm =
    number("wall_junction_mm", 5, "mm", 2, 8, "Width over which fibres turn where the ventricles' walls meet");
inline constexpr Number annulus_mm =
    number("annulus_mm", 6, "mm", 3, 10, "Rows of the wall this near to a valve's rim lie on its annulus");
inline constexpr Number vein_perimeter_min_mm =
    number("vein_perimeter_min_mm", 15, "mm", 8, 30, "Smaller openings of an atrium are holes in its wall");
inline constexpr Number base_cut_mm =
    number("base_cut_mm", 4, "mm", 2, 8, "Faces of a flat base lie this near to its top");
inline constexpr Number apex_radius_mm = number("apex_radius_mm", 5, "mm", 3, 10, "The apex of a ventricle is so wide");
inline constexpr Number papillary_radius_mm =
    number("papillary_radius_mm", 6, "mm", 3, 10, "A papillary muscle's axis is taken from so much of it",
           Basis::unrecorded, "Not recorded; kobashi1998: papillary muscles are 7 +- 2 mm wide");
inline constexpr Number stimulus_radius_mm =
    number("stimulus_radius_mm", 4, "mm", 1, 8, "Muscle around a stimulated place, in decks for solvers");

}  // namespace priors
}  // namespace heartgen
