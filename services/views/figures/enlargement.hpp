// The low frequencies of a panel once more, larger, in a corner that hides no point (as in figure 5
// of the paper). Plain functions, any thread.
#pragma once

#include "services/views/figures/panel.hpp"

namespace dyncal::inline views::figures {

// Draws nothing where the lower half of a logarithmic x axis has too few points to be worth a
// closer look, or every corner has points.
void draw_enlargement(Svg& svg, const Panel& panel, const Box& area);

} // namespace dyncal::inline views::figures
