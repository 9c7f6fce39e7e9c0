// Moves the focus when its element is removed, hidden or disabled. The browser would move it to the
// start of the page, and keyboard users would have to go through all of it again.

const FOCUSABLE = 'a[href], button, input, select, summary, [tabindex]';

const canTakeFocus = (element) => element.isConnected && !element.disabled && (element.checkVisibility?.({ visibilityProperty: true }) ?? element.getClientRects().length > 0);
const tabStopsIn = (host) => [...host.querySelectorAll(FOCUSABLE)].filter((e) => e.tabIndex >= 0);
const nameOf = (element) => element.getAttribute('aria-label') ?? element.textContent;

class Focus {
  constructor() {
    this.last = null;
    addEventListener('focusin', ({ target }) => this.remember(target));
    addEventListener('focusout', () => setTimeout(() => this.left()));
    new MutationObserver(() => this.check()).observe(document.body, { subtree: true, childList: true, attributes: true, attributeFilter: ['hidden', 'disabled', 'open', 'class'] });
  }

  // Records the surroundings of the focused element.
  remember(element) {
    const ancestors = [];
    for (let host = element.parentElement; host; host = host.parentElement) ancestors.push(host);
    this.last = { element, ancestors, tabStops: tabStopsIn(document), name: nameOf(element), isVisible: element.matches(':focus-visible') };
  }

  // Forgets the element after a click outside of it, if it still exists a moment later.
  left() { if (this.last && document.activeElement === document.body && canTakeFocus(this.last.element)) this.last = null; }

  check() {
    const at = document.activeElement;
    if (!this.last || (at && at !== document.body && canTakeFocus(at)) || canTakeFocus(this.last.element)) return;
    const { isVisible } = this.last;
    const next = this.successor(this.last);
    this.last = null;
    // For users of a pointer the page does not scroll.
    next?.focus({ preventScroll: !isVisible });
  }

  // Returns the redrawn element; else the first of its `data-focus-next`; else, in its nearest
  // ancestor, the only element with `data-focus-target` or the next one in the order.
  successor({ element, ancestors, tabStops, name }) {
    const hosts = ancestors.filter((host) => host.isConnected);
    const twin = tabStopsIn(hosts[0]).find((e) => e.tagName === element.tagName && nameOf(e) === name && canTakeFocus(e));
    const named = (element.dataset.focusNext ?? '').split(' ').map((id) => byId(id));
    const preferred = twin ?? named.find((e) => e && canTakeFocus(e));
    if (preferred) return preferred;
    const index = tabStops.indexOf(element);
    const order = [...tabStops.slice(index + 1), ...tabStops.slice(0, index).reverse()];
    for (const host of hosts) {
      const candidates = tabStopsIn(host).filter(canTakeFocus);
      const targets = candidates.filter((e) => 'focusTarget' in e.dataset);
      const next = (targets.length === 1 ? targets[0] : undefined) ?? order.find((e) => candidates.includes(e)) ?? candidates[0];
      if (next) return next;
    }
    return null;
  }
}
