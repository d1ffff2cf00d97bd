/* The part of zstd's interface that readers of scene files use, for frames whose blocks are stored
 * as they are: scenes for the web are packed as a whole, by what browsers unpack themselves. Stands
 * in the place of zstd's own header. */
#ifndef RELUMINE_WEB_ZSTD_H
#define RELUMINE_WEB_ZSTD_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ZSTD_CONTENTSIZE_UNKNOWN (0ULL - 1)
#define ZSTD_CONTENTSIZE_ERROR (0ULL - 2)

typedef struct ZSTD_DCtx ZSTD_DCtx;
typedef struct ZSTD_inBuffer {
    const void* src;
    size_t size;
    size_t pos;
} ZSTD_inBuffer;
typedef struct ZSTD_outBuffer {
    void* dst;
    size_t size;
    size_t pos;
} ZSTD_outBuffer;

size_t ZSTD_compressBound(size_t size);
size_t ZSTD_compress(void* to, size_t capacity, const void* from, size_t size, int level);
unsigned ZSTD_isError(size_t code);
const char* ZSTD_getErrorName(size_t code);
size_t ZSTD_findFrameCompressedSize(const void* from, size_t size);
unsigned long long ZSTD_getFrameContentSize(const void* from, size_t size);
size_t ZSTD_decompress(void* to, size_t capacity, const void* from, size_t size);
ZSTD_DCtx* ZSTD_createDCtx(void);
size_t ZSTD_freeDCtx(ZSTD_DCtx* context);
size_t ZSTD_decompressStream(ZSTD_DCtx* context, ZSTD_outBuffer* out, ZSTD_inBuffer* in);

#ifdef __cplusplus
}
#endif

#endif
