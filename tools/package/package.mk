# The release tarball and Debian packages of it. Included by the top Makefile.
#
# dpkg-buildpackage builds in a folder of its own, from what the tarball holds, and asks no network for anything: the
# page of `screed report`, which npm makes, is in the tarball.

NUMBER := $(firstword $(VERSION_WORDS))
RELEASE := screed-$(NUMBER)
PACKAGE_WORK := $(BUILD_ROOT)/package
# Who answers for the packages, as Debian's own tools read it.
export DEBFULLNAME ?= The Screed contributors
export DEBEMAIL ?= screed@example.org

.PHONY: dist packages test-packages
dist: $(PACKAGE_WORK)/$(RELEASE).tar.gz  ## build/package/screed-NUMBER.tar.gz: committed sources, page of reports
$(PACKAGE_WORK)/$(RELEASE).tar.gz: $(REPORT_PAGE) FORCE
	@rm -rf $(PACKAGE_WORK)/$(RELEASE) ; mkdir -p $(PACKAGE_WORK)
	@git archive --prefix=$(RELEASE)/ HEAD | tar -x -C $(PACKAGE_WORK)
	@cp $(REPORT_PAGE) $(PACKAGE_WORK)/$(RELEASE)/tools/report/built_page.html
	@tar -cz --sort=name --owner=0 --group=0 --numeric-owner --mtime=@$$(git log -1 --format=%ct) \
	  -C $(PACKAGE_WORK) -f $@ $(RELEASE)
	@echo "  TAR  $@"
packages: dist  ## build/package/*.deb: Debian packages of the committed sources (minutes)
	@rm -rf $(PACKAGE_WORK)/*.deb $(PACKAGE_WORK)/*.changes $(PACKAGE_WORK)/*.buildinfo
	@cp -r tools/package/debian $(PACKAGE_WORK)/$(RELEASE)
	@tools/package/debian_changelog.sh $(NUMBER) > $(PACKAGE_WORK)/$(RELEASE)/debian/changelog
	@cd $(PACKAGE_WORK)/$(RELEASE) && dpkg-buildpackage --build=binary --no-sign > ../build.log 2>&1 || \
	  { tail -n 30 ../build.log >&2 ; exit 1 ; }
	@ls $(PACKAGE_WORK)/*.deb
test-packages: packages  ## install the packages in a fresh Debian, run them from elsewhere, purge them (root; minutes)
	@tests/package/run.sh $(PACKAGE_WORK)
