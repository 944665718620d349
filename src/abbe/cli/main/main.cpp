#include "abbe/cli/cli.h"

int main(int argc, char** argv) {
  return abbe::run_program(argc, argv);
}
