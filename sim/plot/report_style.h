// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch::evaluation {

/// The style sheet of all HTML reports, with the classes that Draw()'s plots use.
const char* ReportStyle();

}  // namespace v2vouch::evaluation
