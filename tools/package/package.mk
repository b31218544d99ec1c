# The release tarball and Debian packages of it. Included by the top Makefile.
#
# dpkg-buildpackage builds in a folder of its own, from what the tarball holds, and asks no network for anything: the
# page of `screed report`, which npm makes, is in the tarball.

PACKAGE_WORK := $(BUILD_ROOT)/package
# That of the release where its tag is checked out; otherwise later than it, by time and commit.
RELEASE_NUMBER := $(firstword $(VERSION_WORDS))
PACKAGE_VERSION = $(RELEASE_NUMBER)$(shell git tag --points-at HEAD 2> /dev/null | grep -qx v$(RELEASE_NUMBER) || \
  git log -1 --date=format:%Y%m%d%H%M --format=+%cd.%h)
PACKAGE_SOURCE = $(PACKAGE_WORK)/screed-$(PACKAGE_VERSION)
# Who signs the packages' changelog, as Debian's own tools read it.
export DEBFULLNAME ?= The Screed contributors
export DEBEMAIL ?= screed@example.org

.PHONY: dist packages test-packages
dist: $(REPORT_PAGE)  ## build/package/screed-VERSION.tar.gz: committed sources, page of reports
	@[ -z "$$(git status --porcelain 2>&1)" ] || \
	  { echo 'dist: needs a git repository without uncommitted changes' >&2 ; exit 1 ; }
	@rm -rf $(PACKAGE_WORK) ; mkdir -p $(PACKAGE_WORK)
	@git archive --prefix=$(notdir $(PACKAGE_SOURCE))/ HEAD | tar -x -C $(PACKAGE_WORK)
	@cp $(REPORT_PAGE) $(PACKAGE_SOURCE)/tools/report/built_page.html
	@tar -cz --sort=name --owner=0 --group=0 --numeric-owner --mtime=@$$(git log -1 --format=%ct) \
	  -C $(PACKAGE_WORK) -f $(PACKAGE_SOURCE).tar.gz $(notdir $(PACKAGE_SOURCE))
	@echo "  TAR  $(PACKAGE_SOURCE).tar.gz"
# The packages are those of a release build, whatever this make was told.
packages: dist  ## build/package/*.deb: Debian packages of the committed sources (minutes)
	@cp -r $(PACKAGE_SOURCE)/tools/package/debian $(PACKAGE_SOURCE)
	@tools/package/debian_changelog.sh $(PACKAGE_VERSION) > $(PACKAGE_SOURCE)/debian/changelog
	@cd $(PACKAGE_SOURCE) && env -u MAKEFLAGS -u MFLAGS -u MAKELEVEL -u MAKEOVERRIDES -u INSTALLED \
	  dpkg-buildpackage --build=binary --no-sign > ../build.log 2>&1 || { tail -n 30 ../build.log >&2 ; exit 1 ; }
	@ls $(PACKAGE_WORK)/*.deb
# At once, not after the building.
$(if $(filter test-packages,$(MAKECMDGOALS)),$(if $(filter-out 0,$(shell id -u)),$(error \
  test-packages: needs root, for a Debian of its own)))
test-packages: packages $(SCREED)  ## install the packages in a fresh Debian, run them there, purge them (root; minutes)
	@SCREED_PROGRAM=$(abspath $(SCREED)) tests/package/run.sh $(PACKAGE_WORK)
