// SPDX-License-Identifier: GPL-3.0-or-later
#include <heartgen/build.hpp>

namespace heartgen {

Recipe default_recipe() {
  Recipe recipe;
  recipe.segmentation = default_segmentation();
  return recipe;
}

}  // namespace heartgen
