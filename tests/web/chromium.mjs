// The browser that tests and measurements use, and where what they look at was built (CUESTA_WEB; default: build/web).

import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

export const here = dirname(fileURLToPath(import.meta.url));
export const packages = join(here, '../../apps/web/node_modules');
export const web = process.env.CUESTA_WEB ?? join(here, '../../build/web');
const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find((p) => existsSync(p));

/** What has to be installed first; nothing if all is there. */
export function missingBrowser() {
  if (!executablePath) return 'chromium (apt-get install chromium)';
  if (!existsSync(join(packages, 'playwright-core'))) return 'playwright-core (tools/web)';
  return undefined;
}

/** Or built. */
export function missing() {
  if (!existsSync(join(web, 'page/index.html'))) return 'the built page (tools/web)';
  return missingBrowser();
}

/** Without a screen, drawing in software. */
export function launch() {
  const { chromium } = createRequire(join(packages, 'x'))('playwright-core');
  const args = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
  return chromium.launch({ executablePath, args });
}
