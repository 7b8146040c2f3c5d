# What `cmake --install` brings to a machine: the programs, the units that start them, and the limits that the host should have.
include(GNUInstallDirs)
install(TARGETS dyncal dyncal-dau dyncal-acs dyncal-can dyncal-dso dyncal-analysis dyncal-virtual-bench RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES deploy/systemd/dyncal-dau@.service deploy/systemd/dyncal-acs@.service deploy/systemd/dyncal-can@.service deploy/systemd/dyncal-dso@.service
              deploy/systemd/dyncal-analysis.service
        DESTINATION lib/systemd/system)
install(FILES deploy/sysctl/60-dyncal.conf DESTINATION lib/sysctl.d)
