// Device cl of a library that was built without OpenCL (CMake: RIVULET_OPENCL): there is none, and the sentence says why.
#include "engine/compute/device_cl.h"

namespace rivulet {

namespace {
Error absent() { return failed("this Rivulet was built without OpenCL; build it with RIVULET_OPENCL=ON"); }
}  // namespace

Result<std::unique_ptr<Device>> makeClDevice(const ShaderFiles&, Log, const ClOptions&) { return absent(); }
std::vector<ClDeviceListing> listClDevices() { return {}; }
Status checkClDevice(std::string_view) { return ok(); }

// No device has one.
struct GlSharing::Impl {};
GlSharing::GlSharing(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GlSharing::~GlSharing() = default;
Result<GlSharing::Wrapped> GlSharing::wrap(unsigned) const { return absent(); }
Status GlSharing::copy(std::span<const Copy>) const { return absent(); }

}  // namespace rivulet
