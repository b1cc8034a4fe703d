// The files that a model may name: plain files in the folder of the model and below.
#pragma once

#include <assimp/IOSystem.hpp>

#include <cstddef>
#include <set>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rivulet {

// Opens files for assimp, and finds textures.
class FolderFiles final : public Assimp::IOSystem {
  public:
    // `model`: the path of the model. It may be a link to another folder; the files that it names lie in its own.
    explicit FolderFiles(const std::string& model);

    // The path without links of a file that the model names. Error: a phrase that names the file, which is missing, not a plain file, or
    // outside the folder, through `..`, an absolute path or a link.
    Result<std::string> resolve(const std::string& path) const;

    // The phrase of the first file that was refused, but for files that are missing, which assimp may do without; "": none.
    const std::string& refusal() const { return refusal_; }

    bool Exists(const char* path) const override;
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* path, const char* mode) override;
    void Close(Assimp::IOStream* file) override;

  private:
    std::string model_, folder_;  // without links
    std::string refusal_;
    std::set<std::string> opened_;
};

}  // namespace rivulet
