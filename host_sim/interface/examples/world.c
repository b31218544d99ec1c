/* A robot with its firmware levels a bed in the stand-in, for a minute of its life: where it is and
   how level its ground is. `screed sim EXPERIMENT --hal surrogate --duration 60` has the same bits.

     screed prepare level_bed --out level_bed.world
     cc world.c $(pkg-config --cflags --libs screed-core) && ./a.out level_bed.world */
#include <screed/world.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void stop(const char* text) {
  fprintf(stderr, "world: %s\n", text);
  exit(2);
}

static void* read_file(const char* name, size_t* size) {
  FILE* file = fopen(name, "rb");
  void* bytes = NULL;
  if (file == NULL || fseek(file, 0, SEEK_END) != 0) stop("the file cannot be read");
  *size = (size_t)ftell(file);
  rewind(file);
  bytes = malloc(*size);
  if (bytes == NULL || fread(bytes, 1, *size, file) != *size) stop("the file cannot be read");
  fclose(file);
  return bytes;
}

/* A number of a robot's row, by the name of its column. */
static double column_of(const unsigned char* row, const char* name) {
  screed_column column;
  for (int i = 0; screed_table_column(SCREED_FRAMES, i, &column); ++i) {
    double value;
    if (strcmp(column.name, name) != 0 || column.type != SCREED_DOUBLE) continue;
    memcpy(&value, row + column.offset, sizeof value);
    return value;
  }
  stop("no such column");
  return 0.0;
}

int main(int count, char** words) {
  screed_error error;
  screed_world* world;
  screed_level level;
  unsigned char* row = malloc(screed_table_row(SCREED_FRAMES));
  size_t size = 0;
  void* prepared = count == 2 ? read_file(words[1], &size) : NULL;
  if (prepared == NULL || row == NULL) stop("world FILE");
  world = screed_world_create(prepared, size, 1, &error);
  free(prepared);
  if (world == NULL) stop(error.text);
  for (int second = 1; second <= 60; ++second) {
    if (screed_world_advance(world, 100, NULL, &error) != SCREED_OK ||
        screed_world_row(world, 0, SCREED_FRAMES, row, &error) != SCREED_OK) {
      stop(error.text);
    }
    if (second % 10 == 0)
      printf("%2d s: x %.17g m, y %.17g m\n", second, column_of(row, "x"), column_of(row, "y"));
  }
  if (screed_world_level(world, 0, &level, &error) != SCREED_OK) stop(error.text);
  printf("height about level %.17g m\n", level.level_deviation);
  screed_world_destroy(world);
  free(row);
  return 0;
}
