// What the parts of the interposer share: calls that are counted and, by their number, made to fail.
#pragma once

#include <dlfcn.h>

#include <cstdint>

namespace faults {

// The kinds of calls. Names of them: see interposer.cpp.
enum Kind {
    kMemory,     // malloc and its relatives, operator new: ENOMEM
    kMap,        // mmap: ENOMEM
    kOpen,       // open for writing: ENOSPC
    kOpenRead,   // open for reading, pipes, sockets: EMFILE
    kRead,       // EIO
    kWrite,      // ENOSPC
    kSync,       // EIO
    kRename,     // EIO
    kLink,       // EPERM
    kClose,      // the file is closed, and EIO
    kFolder,     // mkdir: ENOSPC
    kProcess,    // posix_spawn, fork: EAGAIN
    kThread,     // pthread_create: EAGAIN
    kSend,       // to a socket: EPIPE
    kGlMemory,   // GL_OUT_OF_MEMORY of buffers, textures and renderbuffers
    kGlMap,      // glMapNamedBufferRange: no address
    kGlProgram,  // a shader that does not compile, a program that does not link
    kGlFence,    // glFenceSync: none
    kGlTarget,   // an incomplete framebuffer
    kGlLost,     // GL_CONTEXT_LOST from this dispatch or draw on
    kClMemory,   // clCreateBuffer: CL_MEM_OBJECT_ALLOCATION_FAILURE
    kClCommand,  // clEnqueue*, clFinish: CL_OUT_OF_RESOURCES
    kClBuild,    // clBuildProgram, clCreateKernel: CL_OUT_OF_HOST_MEMORY
    kClOpen,     // clCreateContext, clCreateCommandQueue: CL_OUT_OF_HOST_MEMORY
    kKinds
};

// Whether this call of the kind must fail. `caller` is the return address of the interposed function: only calls of the module under test
// count, made directly or through libraries that pass failures on (the C and C++ runtimes, fmt, jsoncpp).
bool fails(Kind kind, const void* caller);
// Whether a call failed that stays failed (a lost device).
bool failed(Kind kind);

// The function that would have been called.
template <class F>
F* next(F*, const char* name) {
    return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

}  // namespace faults

#define FAULTS_CALLER __builtin_return_address(0)
// The function that `name` is without the interposer.
#define FAULTS_NEXT(name)                                      \
    ([] {                                                      \
        static auto* const behind = faults::next(name, #name); \
        return behind;                                         \
    }())
