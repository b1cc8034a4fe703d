// A Model as bytes, from rivulet_import (engine/scene/import) to the program that started it. Both run on one machine and are built
// together: the format has no version. The reader trusts nothing, because a file may have taken the writer over.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/scene/model.h"

namespace rivulet {

// Receives the next bytes; false: they cannot be sent.
using WireSink = std::function<bool(std::span<const std::byte>)>;

// False: the sink refused bytes. What no file sets (skin, eyes, grain, hair) is not sent.
bool sendModel(const Model& model, const WireSink& sink);
// Sends a phrase instead of a model: what is wrong with the file.
bool sendFault(std::string_view phrase, const WireSink& sink);

// The model that was sent: one without a fault (model_check.h) for any bytes. Its memory grows with the bytes read. Control characters of
// names become '?'. Error (badInput): the phrase that was sent, at most 400 bytes of it, or one for bytes that are no answer.
Result<Model> receiveModel(std::span<const std::byte> bytes);

}  // namespace rivulet
