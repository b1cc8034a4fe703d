// A RecordedFrame of a world.
#pragma once

#include "fluid/io/recording.h"

namespace rivulet {

class FluidWorld;

// What is drawn of the world now, without places and corners of solids. Memory that `frame` holds is used again. Waits for the device.
void frameOf(const FluidWorld& world, RecordedFrame& frame);

}  // namespace rivulet
