// SPDX-License-Identifier: MIT
// The version of the library, for the preprocessor.
#pragma once

// CMakeLists.txt reads the three numbers from these lines.
#define SILT_VERSION_MAJOR 0
#define SILT_VERSION_MINOR 2
#define SILT_VERSION_PATCH 0

/// One number that grows with the version, two digits for each of minor and patch: 200 is 0.2.0.
#define SILT_VERSION (SILT_VERSION_MAJOR * 10000 + SILT_VERSION_MINOR * 100 + SILT_VERSION_PATCH)
