# The pictures of the pages. Included by the top Makefile.

.PHONY: pictures check-pictures
pictures: $(SCREED) $(REPORT_PAGE)  ## draw the pictures of the pages anew (PICTURES='report.png soil_*'; all: hours)
	@PATH="$(abspath $(dir $(SCREED))):$$PATH" tools/pictures/pictures.py make $(foreach it,$(PICTURES),'$(it)')
check-pictures:
	@tools/pictures/pictures.py check
