// errorOf: an exception of the standard library or of another library as an Error, in plain words.
#pragma once

#include <exception>

#include "engine/core/result.h"

namespace rivulet {

// `thrown` is not null: std::current_exception() in a catch block. The Error is `failed`.
Error errorOf(const std::exception_ptr& thrown);

}  // namespace rivulet
