#include "tests/unit/gl_waits.h"

#include <rivulet_glad/gl.h>

#include <string_view>

#include "engine/app/gl_count.h"

namespace rivulet::testing {
namespace {

std::map<std::string, size_t> seenWaits;  // waits that depend on arguments
GLuint untouched = 0;                     // the buffer that has just got its memory: no command of the GPU uses it yet

// Timestamps, in the order in which the GPU writes them: if one is available, so are all before it.
size_t timestamps = 0, newestAvailable = 0;
std::map<GLuint, size_t> timestampOf;

bool isAvailable(GLuint query) {
    const auto found = timestampOf.find(query);
    return found != timestampOf.end() && found->second <= newestAvailable;
}

PFNGLCLIENTWAITSYNCPROC waitSync = nullptr;
GLenum GLAD_API_PTR countWaitSync(GLsync sync, GLbitfield flags, GLuint64 nanoseconds) {
    if (nanoseconds > 0) ++seenWaits["glClientWaitSync"];
    return waitSync(sync, flags, nanoseconds);
}

PFNGLNAMEDBUFFERSTORAGEPROC namedStorage = nullptr;
void GLAD_API_PTR seeStorage(GLuint buffer, GLsizeiptr bytes, const void* data, GLbitfield flags) {
    untouched = buffer;
    namedStorage(buffer, bytes, data, flags);
}

PFNGLCLEARNAMEDBUFFERDATAPROC clearNamed = nullptr;
void GLAD_API_PTR seeClear(GLuint buffer, GLenum inside, GLenum format, GLenum type, const void* data) {
    if (buffer == untouched) untouched = 0;
    clearNamed(buffer, inside, format, type, data);
}

PFNGLMAPNAMEDBUFFERRANGEPROC mapNamedRange = nullptr;
void* GLAD_API_PTR countMap(GLuint buffer, GLintptr offset, GLsizeiptr bytes, GLbitfield access) {
    if ((access & GL_MAP_UNSYNCHRONIZED_BIT) == 0 && buffer != untouched) ++seenWaits["glMapNamedBufferRange"];
    untouched = 0;
    return mapNamedRange(buffer, offset, bytes, access);
}

PFNGLQUERYCOUNTERPROC queryCounter = nullptr;
void GLAD_API_PTR seeTimestamp(GLuint query, GLenum target) {
    timestampOf[query] = ++timestamps;
    queryCounter(query, target);
}

// The four functions glGetQueryObject*.
template <class Value>
struct QueryObject {
    static inline void(GLAD_API_PTR* driver)(GLuint, GLenum, Value*) = nullptr;
    static inline const char* name = nullptr;
    static void GLAD_API_PTR call(GLuint query, GLenum what, Value* result) {
        if (what == GL_QUERY_RESULT && !isAvailable(query)) ++seenWaits[name];
        driver(query, what, result);
        const auto found = timestampOf.find(query);
        const bool there = what == GL_QUERY_RESULT || (what == GL_QUERY_RESULT_AVAILABLE && *result != 0);
        if (there && found != timestampOf.end() && found->second > newestAvailable) newestAvailable = found->second;
    }
};

template <class F>
gpu::FunctionPointer instead(gpu::FunctionPointer found, F*& driver, F* ours) {
    driver = reinterpret_cast<F*>(found);
    return reinterpret_cast<gpu::FunctionPointer>(ours);
}
template <class Query>
gpu::FunctionPointer insteadOf(gpu::FunctionPointer found, const char* name) {
    Query::name = name;
    return instead(found, Query::driver, &Query::call);
}

}  // namespace

gpu::FunctionPointer waitsFind(const char* name) {
    const gpu::FunctionPointer found = countingFind(name);
    const std::string_view which = name;
    if (found == nullptr) return nullptr;
    if (which == "glClientWaitSync") return instead(found, waitSync, countWaitSync);
    if (which == "glNamedBufferStorage") return instead(found, namedStorage, seeStorage);
    if (which == "glClearNamedBufferData") return instead(found, clearNamed, seeClear);
    if (which == "glMapNamedBufferRange") return instead(found, mapNamedRange, countMap);
    if (which == "glQueryCounter") return instead(found, queryCounter, seeTimestamp);
    if (which == "glGetQueryObjectiv") return insteadOf<QueryObject<GLint>>(found, "glGetQueryObjectiv");
    if (which == "glGetQueryObjectuiv") return insteadOf<QueryObject<GLuint>>(found, "glGetQueryObjectuiv");
    if (which == "glGetQueryObjecti64v") return insteadOf<QueryObject<GLint64>>(found, "glGetQueryObjecti64v");
    if (which == "glGetQueryObjectui64v") return insteadOf<QueryObject<GLuint64>>(found, "glGetQueryObjectui64v");
    return found;
}

void startGlWaits() {
    startGlCount();
    seenWaits.clear();
}

std::map<std::string, size_t> glWaits() {
    std::map<std::string, size_t> waits = seenWaits;
    const GlCalls calls = glCount();
    for (const char* name :
         {"glFinish", "glGetNamedBufferSubData", "glGetBufferSubData", "glReadPixels", "glReadnPixels", "glGetTexImage",
          "glGetTextureImage", "glGetTextureSubImage", "glGetnTexImage", "glMapBuffer", "glMapBufferRange", "glMapNamedBuffer"})
        if (const auto found = calls.byName.find(name); found != calls.byName.end()) waits.insert(*found);
    return waits;
}

}  // namespace rivulet::testing
