#pragma once
/// Memory in huge pages, for commands that use much of it at random.

namespace cuesta::app {

/// Runs the program anew, once, with glibc's malloc asking for huge pages: it looks only when a process
/// starts (GLIBC_TUNABLES, glibc.malloc.hugetlb). Builds take about a seventh less time for it
/// (docs/design-notes.md). Returns if that is not worth a start, no argument being a folder or a file of 256
/// KiB; if the variable is set already, by whom ever; or where there is no glibc or no permission: then all
/// works the same, more slowly. @param argv  of main()
void use_huge_pages(char** argv);

}  // namespace cuesta::app
