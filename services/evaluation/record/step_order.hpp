// The excitations of a run in their order: the planned steps, then those that are excited again.
// The lines of a multi-sine are one excitation, which counts as the first of their steps.
//
// Everything that follows a run through its samples counts excitations from 0 in this order, so
// that a step that is repeated is one more to be found behind all others. Belongs to one thread;
// the recipe must outlive it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"

namespace dyncal::inline evaluation {

class StepOrder {
public:
  explicit StepOrder(const Recipe& recipe) : recipe_(recipe), lines_(recipe.lines_at_once()) {}

  [[nodiscard]] std::size_t size() const { return planned() + repeats_.size(); }
  // REQUIRES for these: place < size()
  [[nodiscard]] std::size_t index(std::size_t place) const; // among the recipe's steps
  [[nodiscard]] const RecipeStep& step(std::size_t place) const {
    return recipe_.steps[index(place)];
  }
  // All that are excited together, this one first.
  [[nodiscard]] std::span<const RecipeStep> lines(std::size_t place) const {
    return std::span(recipe_.steps).subspan(index(place), lines_);
  }
  [[nodiscard]] std::uint32_t attempt(std::size_t place) const; // from 1

  // Where this attempt of a step is; `step` as the recipe numbers it. Nothing if there is none.
  [[nodiscard]] std::optional<std::size_t> find(std::uint32_t step, std::uint32_t attempt) const;
  // The steps that were excited again so far, by their numbers: takes those that are new.
  void repeat(const std::vector<std::uint32_t>& steps);
  // One more excitation of a step, unless it is known. Passes over a step that the recipe does not
  // have.
  void repeat(std::uint32_t step, std::uint32_t attempt);

private:
  struct Repeat {
    std::size_t index;
    std::uint32_t attempt;
  };

  [[nodiscard]] std::size_t planned() const { return recipe_.steps.size() / lines_; }
  // Of the first step that is excited with it.
  [[nodiscard]] std::optional<std::size_t> index_of(std::uint32_t step) const;

  const Recipe& recipe_;
  std::size_t lines_; // of an excitation
  std::vector<Repeat> repeats_;
};

} // namespace dyncal::inline evaluation
