#include "fluid/render/kept_pictures.h"

#include <algorithm>

namespace rivulet {

namespace {
constexpr uint64_t kUnused = 48;  // calls, up to four for each view: a host may draw 12 in a frame
}  // namespace

size_t KeptPicture::bytes() const {
    size_t sum = 0;
    for (const gpu::Texture& texture : textures)
        if (texture) sum += texture.desc().bytes();
    return sum;
}

size_t KeptPictures::bytes() const {
    size_t sum = 0;
    for (const Entry& entry : entries_) sum += entry.picture->bytes();
    return sum;
}

void KeptPictures::next() {
    ++now_;
    std::erase_if(entries_, [this](const Entry& entry) { return entry.used + kUnused < now_; });
}

std::shared_ptr<KeptPicture> KeptPictures::find(const Key& key, std::span<const Wanted> parts) {
    next();
    const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.key == key; });
    if (at == entries_.end()) {
        entries_.push_back({key, std::make_shared<KeptPicture>(), now_});
        return nullptr;
    }
    at->used = now_;
    size_t more = 0;
    for (const auto& [part, desc] : parts)
        if (!at->picture->textures[part]) more += desc.bytes();
    if (bytes() + more > most_) return nullptr;
    for (const auto& [part, desc] : parts) {
        gpu::Texture& texture = at->picture->textures[part];
        if (texture) continue;
        Result<gpu::Texture> made = gpu::Texture::create(desc);
        if (!made) return nullptr;
        texture = std::move(*made);
    }
    return at->picture;
}

}  // namespace rivulet
