// Files that only this user can have written: the caches. What another user may have put there is not read.
#pragma once

#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rivulet {

// A folder is private if it belongs to this user and others may not write to it, and if no other user may rename it: the folder that
// contains it belongs to this user or to root and is not writable by others, or has the sticky bit. Error (failed): `folder` exists and is
// not private. If it is, others may no longer read it either (0700). A folder that does not exist is no error.
Status checkPrivateFolder(const std::string& folder);

// The same for a folder that is made first if it is missing, together with those above it (0700). Further error: it cannot be made.
Status makePrivateFolder(const std::string& folder);

// Error (failed): `path` exists and is a link, a folder, a device or a pipe, belongs to another user, or others may write to it.
Status checkPrivateFile(const std::string& path);

// Writes a whole file for this user alone (0600) by temporary name and rename. It replaces a file of another user, or a link.
Status writePrivateFile(const std::string& path, std::string_view bytes);

}  // namespace rivulet
