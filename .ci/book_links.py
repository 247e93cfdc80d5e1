"""Checks the links of a built book: each link must lead to a file of the book, and to an existing anchor in this file.
The argument is the folder of the book. The default is target/dist/book."""
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id":
                self.anchors.add(value)
            if name in ("href", "src") and value and tag in ("a", "img"):
                self.links.append(value)


root = Path(sys.argv[1] if len(sys.argv) > 1 else "target/dist/book").resolve()
pages = {path: Page(path) for path in root.rglob("*.html") if path.name not in ("print.html", "404.html", "toc.html")}
missing, count = [], 0
for path, page in pages.items():
    for link in page.links:
        parts = urlsplit(link)
        if parts.scheme or parts.netloc:
            continue
        count += 1
        target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
        if not target.exists():
            missing.append(f"{path.relative_to(root)}: {link}")
        elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
            missing.append(f"{path.relative_to(root)}: no anchor {link}")
print("\n".join(missing) or f"{len(pages)} pages, {count} links are valid")
sys.exit(bool(missing) or not pages)
