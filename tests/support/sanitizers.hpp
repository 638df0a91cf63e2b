// SPDX-License-Identifier: MIT
// Whether this program is compiled with a sanitizer.
#pragma once

#ifdef __has_feature
#define SILT_HAS_FEATURE(feature) __has_feature(feature)
#else
#define SILT_HAS_FEATURE(feature) 0
#endif

#if defined(__SANITIZE_ADDRESS__) || SILT_HAS_FEATURE(address_sanitizer)
#define SILT_HAS_ADDRESS_SANITIZER 1
#else
#define SILT_HAS_ADDRESS_SANITIZER 0
#endif

#if defined(__SANITIZE_THREAD__) || SILT_HAS_FEATURE(thread_sanitizer)
#define SILT_HAS_THREAD_SANITIZER 1
#else
#define SILT_HAS_THREAD_SANITIZER 0
#endif
