// A RecordedFrame of a world.
#pragma once

#include <functional>
#include <memory>

#include "fluid/io/recording.h"

namespace rivulet {

class FluidWorld;

// What is drawn of the world now, without places and corners of solids. Memory that `frame` holds is used again. Waits for the device.
void frameOf(const FluidWorld& world, RecordedFrame& frame);
// The same without waiting: `then` is called once `frame` is complete, on the cpu before this returns, on a GPU during a later
// Device::poll(). The world may be stepped and destroyed meanwhile.
void frameLater(const FluidWorld& world, const std::shared_ptr<RecordedFrame>& frame, std::function<void()> then);

}  // namespace rivulet
