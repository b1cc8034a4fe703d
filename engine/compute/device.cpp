#include "engine/compute/device.h"

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
    ASSERT(false, "hand a Backend that exists");
}

Buffer::~Buffer() {
    if (device_) device_->release(handle_, bytes_);
}

}  // namespace rivulet
