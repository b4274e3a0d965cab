// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// Value that a chi-square variable of `degrees` (1 to 6) degrees of freedom stays below with the
/// given probability in (0, 1): 18.4 and 21.1 for 0.9999 and two and three degrees.
double ChiSquareQuantile(double probability, int degrees);

}  // namespace v2vouch
