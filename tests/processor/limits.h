// Embree as it runs on other processors, for tests.
#pragma once

namespace relumine::processor {

/// Embree starts with these settings from now on, as in "isa=avx2"; nullptr: as RELUMINE_PROCESSOR
/// says, or as it likes.
void set_embree(const char* settings);

} // namespace relumine::processor
