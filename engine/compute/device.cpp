#include "engine/compute/device.h"

#include <fmt/format.h>

#include "engine/core/assert.h"
#include "engine/core/readable_bytes.h"

namespace rivulet {

const char* backendName(Backend backend) {
    switch (backend) {
        case Backend::cpu:
            return "cpu";
        case Backend::gl:
            return "gl";
        case Backend::cl:
            return "cl";
    }
    ASSERT(false, "pass a valid Backend");
}

Status Device::checkLimit(size_t bytes) const {
    const size_t used = bytesAllocated();
    if (used > mostBytes_ || bytes > mostBytes_ - used)
        return noMemory(fmt::format("cannot allocate {}: {} of the allowed {} are in use; raise the limit or use fewer particles",
                                    readableBytes(bytes), readableBytes(used), readableBytes(mostBytes_)));
    if (mayAllocate_ && !mayAllocate_(bytes))
        return noMemory(fmt::format("cannot allocate {}: the host refuses it; use fewer particles", readableBytes(bytes)));
    return ok();
}

Buffer::~Buffer() {
    if (device_) device_->release(handle_, bytes_);
}

}  // namespace rivulet
