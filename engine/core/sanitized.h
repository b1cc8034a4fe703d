// Whether this build has a sanitizer (RIVULET_SANITIZE): such programs reserve terabytes of address space, and are slower.
#pragma once

namespace rivulet {

#if defined(__has_feature)
inline constexpr bool kThreadSanitized = __has_feature(thread_sanitizer);
inline constexpr bool kSanitized = kThreadSanitized || __has_feature(address_sanitizer) || __has_feature(memory_sanitizer);
#elif defined(__SANITIZE_THREAD__)
inline constexpr bool kThreadSanitized = true, kSanitized = true;
#elif defined(__SANITIZE_ADDRESS__)
inline constexpr bool kThreadSanitized = false, kSanitized = true;
#else
inline constexpr bool kThreadSanitized = false, kSanitized = false;
#endif

}  // namespace rivulet
