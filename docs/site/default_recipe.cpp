// SPDX-License-Identifier: GPL-3.0-or-later
// Prints the recipe with every setting's default and meaning, from which the site's recipe reference is made.
#include <cstdio>

#include "model/recipe.hpp"

int main() {
  heartgen::Recipe recipe;
  recipe.segmentation = heartgen::default_segmentation();
  recipe.regions.emplace_back();
  std::fputs(heartgen::write_recipe(recipe, true).c_str(), stdout);
  return 0;
}
