// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace v2vouch {

/// White noise of an evenly sampled smooth signal: the median of |x[i+1] - 2 x[i] + x[i-1]|, whose
/// variance is 6 sigma^2, over 0.6745 sqrt(6). NaN for fewer than 20 values.
double WhiteSigma(const std::vector<double>& signal);

/// The same, believed within a quarter of what the messages state (their median) and all of it,
/// since stated figures hold systematic errors too; the stated one for too short a signal. Where
/// nothing of use is stated, `usual` stands for it.
double WhiteSigmaWithin(const std::vector<double>& signal, std::vector<double> stated,
                        double usual);

}  // namespace v2vouch
