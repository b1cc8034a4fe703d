// Numbers of several bytes go by planes, block by block: all first bytes, then all second bytes and so on. Neighbours differ in their low
// bytes alone, so that the others pack well.
#include "fluid/voxel/packed_array.h"

#include <zstd.h>
#include <zstd_errors.h>

#include <new>

namespace rivulet {
namespace {

constexpr int kLevel = 3;
constexpr int kMostWindowLog = 23;  // 8 MiB: what a frame may make the reader keep; level 3 asks for 2 MiB

void toPlanes(std::span<const std::byte> items, size_t itemBytes, std::span<std::byte> planes) {
    const size_t count = items.size() / itemBytes;
    for (size_t b = 0; b < itemBytes; ++b) {
        for (size_t k = 0; k < count; ++k) planes[b * count + k] = items[k * itemBytes + b];
    }
}

void fromPlanes(std::span<const std::byte> planes, size_t itemBytes, std::span<std::byte> items) {
    const size_t count = items.size() / itemBytes;
    for (size_t b = 0; b < itemBytes; ++b) {
        for (size_t k = 0; k < count; ++k) items[k * itemBytes + b] = planes[b * count + k];
    }
}

void require(size_t code) {
    if (ZSTD_isError(code) != 0) throw std::bad_alloc();  // nothing else can go wrong with bytes that are to be compressed
}

}  // namespace

struct ArrayPacker::Impl {
    std::unique_ptr<ZSTD_CCtx, size_t (*)(ZSTD_CCtx*)> context{ZSTD_createCCtx(), ZSTD_freeCCtx};
    std::vector<std::byte> planes;
};

ArrayPacker::ArrayPacker(std::string& out) : impl_(std::make_unique<Impl>()), out_(out) {
    if (!impl_->context) throw std::bad_alloc();
    require(ZSTD_CCtx_setParameter(impl_->context.get(), ZSTD_c_compressionLevel, kLevel));
}

ArrayPacker::~ArrayPacker() = default;

void ArrayPacker::putBytes(std::span<const std::byte> bytes, size_t itemBytes) {
    const size_t block = ArrayUnpacker::kBlockBytes / itemBytes * itemBytes;
    while (!bytes.empty()) {
        const auto piece = bytes.first(std::min(block, bytes.size()));
        bytes = bytes.subspan(piece.size());
        if (itemBytes == 1) {
            feed(piece, false);
            continue;
        }
        impl_->planes.resize(piece.size());
        toPlanes(piece, itemBytes, impl_->planes);
        feed(impl_->planes, false);
    }
}

void ArrayPacker::finish() { feed({}, true); }

void ArrayPacker::feed(std::span<const std::byte> bytes, bool last) {
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    for (size_t left = 1; last ? left != 0 : in.pos < in.size;) {
        const size_t filled = out_.size();
        out_.resize(filled + ZSTD_CStreamOutSize());
        ZSTD_outBuffer out{out_.data() + filled, ZSTD_CStreamOutSize(), 0};
        left = ZSTD_compressStream2(impl_->context.get(), &out, &in, last ? ZSTD_e_end : ZSTD_e_continue);
        out_.resize(filled + out.pos);
        require(left);
    }
}

struct ArrayUnpacker::Impl {
    std::unique_ptr<ZSTD_DCtx, size_t (*)(ZSTD_DCtx*)> context{ZSTD_createDCtx(), ZSTD_freeDCtx};
    ZSTD_inBuffer in{nullptr, 0, 0};
    bool ended = false;  // the frame has
    std::vector<std::byte> planes;
};

ArrayUnpacker::ArrayUnpacker(std::span<const std::byte> packed) : impl_(std::make_unique<Impl>()) {
    if (!impl_->context) throw std::bad_alloc();
    require(ZSTD_DCtx_setParameter(impl_->context.get(), ZSTD_d_windowLogMax, kMostWindowLog));
    impl_->in = {packed.data(), packed.size(), 0};
}

ArrayUnpacker::~ArrayUnpacker() = default;

// A call takes whole blocks, but for the last of an array: as they were put.
bool ArrayUnpacker::takeBytes(std::span<std::byte> bytes, size_t itemBytes) {
    const size_t block = kBlockBytes / itemBytes * itemBytes;
    while (!bytes.empty()) {
        const auto piece = bytes.first(std::min(block, bytes.size()));
        bytes = bytes.subspan(piece.size());
        if (itemBytes == 1) {
            if (!pull(piece)) return false;
            continue;
        }
        impl_->planes.resize(piece.size());
        if (!pull(impl_->planes)) return false;
        fromPlanes(impl_->planes, itemBytes, piece);
    }
    return true;
}

bool ArrayUnpacker::pull(std::span<std::byte> bytes) {
    ZSTD_outBuffer out{bytes.data(), bytes.size(), 0};
    while (out.pos < out.size) {
        if (impl_->ended) {
            why_ = "it ends too early";
            return false;
        }
        const size_t before = impl_->in.pos + out.pos;
        const size_t left = ZSTD_decompressStream(impl_->context.get(), &out, &impl_->in);
        if (ZSTD_isError(left) != 0) {
            if (ZSTD_getErrorCode(left) == ZSTD_error_memory_allocation) throw std::bad_alloc();
            why_ = "it cannot be unpacked";
            return false;
        }
        impl_->ended = left == 0;
        if (!impl_->ended && impl_->in.pos + out.pos == before) {
            why_ = "it ends too early";
            return false;
        }
    }
    return true;
}

bool ArrayUnpacker::finish() {
    std::byte more{};
    while (!impl_->ended) {
        ZSTD_outBuffer out{&more, 1, 0};
        const size_t before = impl_->in.pos;
        const size_t left = ZSTD_decompressStream(impl_->context.get(), &out, &impl_->in);
        impl_->ended = left == 0;
        if (ZSTD_isError(left) != 0 || out.pos > 0 || (!impl_->ended && impl_->in.pos == before)) {
            why_ = "it does not end where it should";
            return false;
        }
    }
    if (impl_->in.pos != impl_->in.size) why_ = "it does not end where it should";
    return impl_->in.pos == impl_->in.size;
}

}  // namespace rivulet
